"""Running `sherd evaluate`, for the tests of it."""
import json
import os
import subprocess

SHERD = os.environ["SHERD_BIN"]


class Evaluating:
    def evaluate(self, *arguments, status=0):
        """What it prints, as text or from --json; of a failure its one sentence."""
        result = subprocess.run([SHERD, "evaluate", *map(str, arguments)], capture_output=True, text=True, timeout=120)
        self.assertEqual(result.returncode, status, result.stderr)
        if status:
            self.assertEqual(result.stdout, "")
            self.assertRegex(result.stderr, r"\Asherd: [^\n]{8,}[^\n.]\n\Z")
            return result.stderr
        self.assertEqual(result.stderr, "")
        return json.loads(result.stdout) if "--json" in arguments else result.stdout
