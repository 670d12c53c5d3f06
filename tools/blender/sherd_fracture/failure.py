# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The error that the user sees."""


class Failure(Exception):
    """An error, as one sentence for the user."""
