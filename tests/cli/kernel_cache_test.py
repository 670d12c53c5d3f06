#!/usr/bin/python3
"""Where compiled kernels are kept: without HOME, for users without a home, on full disks.

PoCL compiles all kernels for each new folder, which takes seconds: `chosen` asks which folder it is, and one test of each
kind compiles kernels there.

SHERD_BIN names the program.  Run by root, every run of it is one of the user nobody, as in containers and services, and
small file systems are mounted for tests of full and read-only disks; otherwise it runs as the user of the test, and the
latter are skipped.
"""
import json
import os
import resource
import shutil
import stat
import subprocess
import tempfile
import unittest

import skipping
from cli_test import SHERD, sphere, tree, write_obj

NOBODY = 65534
IS_ROOT = os.geteuid() == 0
AS_NOBODY = [shutil.which("setpriv") or "setpriv", "--reuid", str(NOBODY), "--regid", str(NOBODY), "--clear-groups"] if IS_ROOT else []
USER = NOBODY if IS_ROOT else os.geteuid()
DRIVER = os.environ.get("OCL_ICD_VENDORS", "pocl.icd")


class KernelCache(unittest.TestCase):
    def setUp(self):
        self.tmp = tempfile.mkdtemp(prefix="sherd-cache-test-")
        self.addCleanup(shutil.rmtree, self.tmp)
        os.chmod(self.tmp, 0o755)
        self.sherd = shutil.copy2(SHERD, self.path("sherd"))  # where nobody can read it
        os.chmod(self.sherd, 0o755)
        self.mesh = self.path("ball.obj")
        write_obj(self.mesh, sphere(8, 12))
        os.chmod(self.mesh, 0o644)
        self.temporary = self.folder("temporary")
        self.private = os.path.join(self.temporary, f"sherd-cache-{USER}")

    def path(self, name):
        return os.path.join(self.tmp, name)

    def folder(self, name, mode=0o1777):
        os.mkdir(self.path(name))
        os.chmod(self.path(name), mode)
        return self.path(name)

    def arguments(self, out="out"):
        if not os.path.exists(self.path(out)):
            self.folder(out)
        return [self.sherd, "fracture", self.mesh, "-o", self.path(out), "--pieces", "2", "--resolution", "16",
                "--device", "pocl"]

    def environment(self, **variables):
        given = {"PATH": os.environ["PATH"], "OCL_ICD_VENDORS": DRIVER, "TMPDIR": self.temporary, **variables}
        return {name: value for name, value in given.items() if value is not None}

    def run_sherd(self, *arguments, before=(), preexec_fn=None, **variables):
        return subprocess.run([*before, *AS_NOBODY, *(arguments or self.arguments())], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, timeout=300, cwd="/", preexec_fn=preexec_fn,
                              env=self.environment(**variables))

    def works(self, **variables):
        result = self.run_sherd(**variables)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        return result

    def chosen(self, **variables):
        """The folder that a run uses, in which PoCL itself left its first file: nothing is compiled for that."""
        result = self.run_sherd(self.sherd, "doctor", "--json", **variables)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        report = json.loads(result.stdout)
        self.assertIn("Portable Computing Language", [p["name"] for p in report["platforms"] if p["devices"]])
        folder = report["kernel_cache"]["folder"]
        if os.path.exists(folder):  # one of a random name is gone
            self.assertTrue(os.listdir(folder))
        return folder

    def refused(self, result, *words):
        self.assertEqual((result.returncode, result.stdout), (4, ""), result.stderr)
        self.assertRegex(result.stderr, r"\Asherd: [^\n]{8,}[^\n.]\n\Z")
        for word in words:
            self.assertIn(word, result.stderr)

    def mounted(self, name, options):
        """A small file system, gone with the test."""
        folder = self.folder(name)
        mount = subprocess.run(["mount", "-t", "tmpfs", "-o", options + ",mode=1777", "tmpfs", folder], capture_output=True)
        if mount.returncode != 0:
            skipping.skip(self, "MOUNT", "no tmpfs can be mounted here")
        self.addCleanup(subprocess.run, ["umount", folder], check=True)
        return folder


class Homeless(KernelCache):
    def test_no_home_and_later_runs_compile_nothing(self):
        self.works()
        self.assertEqual(stat.S_IMODE(os.stat(self.private).st_mode), 0o700)
        self.assertEqual(os.stat(self.private).st_uid, USER)
        kept = {name for name in tree(self.private) if name.endswith(".so")}
        self.assertTrue(kept)
        self.works()
        self.assertEqual(kept, {name for name in tree(self.private) if name.endswith(".so")})
        self.assertEqual(self.chosen(), self.private)

    def test_homes_that_cannot_be_used(self):
        unwritable = self.folder("unwritable", 0o555)
        for home in ("", "/nonexistent", "/dev/null", unwritable, "/proc"):
            with self.subTest(home=home):
                if IS_ROOT or home not in ("", "/nonexistent") or not os.access("/", os.W_OK):
                    self.assertEqual(self.chosen(HOME=home), self.private)
        self.assertEqual(os.listdir(unwritable), [])

    def test_a_cache_home_that_is_a_file(self):
        home = self.folder("home")
        self.assertEqual(self.chosen(HOME=home, XDG_CACHE_HOME=self.mesh), os.path.join(home, ".cache", "pocl", "kcache"))
        self.assertEqual(os.listdir(self.temporary), [])

    def test_a_home_that_can_be_used(self):
        for variable, inside in (("HOME", ".cache/pocl/kcache"), ("XDG_CACHE_HOME", "pocl/kcache"),
                                 ("POCL_CACHE_DIR", "")):
            folder = self.folder(variable)
            chosen = self.chosen(**{"HOME": self.path("HOME"), variable: folder})
            self.assertEqual(os.path.normpath(chosen), os.path.normpath(os.path.join(folder, inside)))
            self.assertEqual(os.listdir(self.temporary), [])

    def test_variables_that_are_empty(self):
        home = self.folder("home")
        self.assertEqual(self.chosen(HOME=home, XDG_CACHE_HOME="", POCL_CACHE_DIR=""), os.path.join(home, ".cache/pocl/kcache"))
        self.assertEqual(os.listdir(self.temporary), [])
        self.assertEqual(self.chosen(HOME="", XDG_CACHE_HOME="", POCL_CACHE_DIR=""), self.private)

    def test_an_absent_folder_for_temporary_files(self):
        used = f"/tmp/sherd-cache-{USER}"
        if not os.path.lexists(used):
            self.addCleanup(shutil.rmtree, used)
        self.assertEqual(self.chosen(TMPDIR=self.path("absent")), used)
        self.assertEqual(os.listdir(self.temporary), [])

    def test_a_folder_that_the_user_names_is_the_users_word(self):
        for folder in (self.mesh, "/proc/cache"):
            with self.subTest(folder=folder):
                self.refused(self.run_sherd(POCL_CACHE_DIR=folder), folder, "POCL_CACHE_DIR", "PoCL")
        self.assertEqual(os.listdir(self.temporary), [])

    def test_runs_at_once_share_it(self):
        outs = [f"out{i}" for i in range(3)]
        runs = [subprocess.Popen([*AS_NOBODY, *self.arguments(out)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                 text=True, cwd="/", env=self.environment()) for out in outs]
        for run in runs:
            _, said = run.communicate(timeout=300)
            self.assertEqual((run.returncode, said), (0, ""))
        for out in outs:
            self.assertEqual(tree(self.path(out)), tree(self.path(outs[0])))


class Builtin(KernelCache):
    """The built-in device, which is `auto`, keeps nothing and needs no driver."""

    def test_nothing_is_kept(self):
        home = self.folder("home")
        for variables in ({"HOME": home}, {"HOME": None}, {"PATH": None}, {"POCL_CACHE_DIR": "/proc/cache"}):
            with self.subTest(variables=variables):
                self.works_with("auto", **variables)
                self.assertEqual((os.listdir(home), os.listdir(self.temporary)), ([], []))

    def test_drivers_that_fail(self):
        vendors = self.folder("vendors")
        self.works_with("builtin", OCL_ICD_VENDORS=vendors)
        with open(os.path.join(vendors, "none.icd"), "w") as file:
            file.write("libc.so.6\n")
        self.works_with("builtin", OCL_ICD_VENDORS=vendors)

    def works_with(self, device, **variables):
        result = self.run_sherd(*self.arguments()[:-1], device, **variables)
        self.assertEqual((result.returncode, result.stderr), (0, ""))


class Linkers(KernelCache):
    """PoCL links kernels with ld, which it looks for in PATH."""

    def test_a_path_without_it_is_extended(self):
        for name, path in (("none", None), ("without", "/nonexistent:/etc")):
            with self.subTest(path=path):
                self.works(PATH=path, HOME=self.folder(name))

    @skipping.skip_unless(IS_ROOT, "MOUNT", "only root can mount")
    def test_a_machine_without_it(self):
        script = self.path("script")
        with open(script, "w") as file:  # an empty file that is not executable stands in for the real one
            file.write(f"touch {self.path('none')} && mount --bind {self.path('none')} $(readlink -f /usr/bin/ld) || exit 99\n"
                       'exec "$@"\n')
        result = self.run_sherd(*self.arguments(), before=["unshare", "-m", "sh", script], HOME=self.folder("home"))
        if result.returncode == 99:
            skipping.skip(self, "MOUNT", "nothing can be mounted here")
        self.refused(result, "PoCL", "ld", "binutils")


class Strangers(KernelCache):
    """Somebody else may have been first to take the folder's name: kernels are libraries that are loaded."""

    def is_avoided(self, kernels=False):
        before = sorted(os.listdir(self.temporary))
        chosen = self.chosen()
        self.assertTrue(chosen.startswith(self.private + "-"), chosen)
        if kernels:
            self.works()
        self.assertEqual(sorted(os.listdir(self.temporary)), before)  # folders of other names came and went

    def test_a_link_of_that_name(self):
        elsewhere = self.folder("elsewhere")
        os.symlink(elsewhere, self.private)
        self.is_avoided()
        self.assertEqual(os.listdir(elsewhere), [])

    def test_a_folder_that_others_can_write(self):
        os.mkdir(self.private)
        if IS_ROOT:
            os.chown(self.private, NOBODY, NOBODY)
        os.chmod(self.private, 0o770)
        self.is_avoided(kernels=True)
        self.assertEqual(os.listdir(self.private), [])

    @skipping.skip_unless(IS_ROOT, "ROOT", "only root has folders of other users")
    def test_a_folder_of_another_user(self):
        os.mkdir(self.private, 0o700)
        os.chown(self.private, NOBODY - 1, NOBODY - 1)
        self.is_avoided()
        self.assertEqual(os.listdir(self.private), [])

    def test_a_file_of_that_name(self):
        with open(self.private, "w"):
            pass
        self.is_avoided()


class Disks(KernelCache):
    def test_a_full_home(self):
        home = self.mounted("home", "size=1m")
        self.assertEqual(self.chosen(HOME=home), self.private)
        self.refused(self.run_sherd(POCL_CACHE_DIR=home), home, "KiB are free")

    def test_a_home_without_libraries(self):
        home = self.mounted("home", "size=64m,noexec")
        self.assertEqual(self.chosen(HOME=home), self.private)
        self.refused(self.run_sherd(POCL_CACHE_DIR=home), home, "noexec")

    def test_files_that_may_not_grow(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 20, 1 << 20))
        self.refused(self.run_sherd(HOME=self.folder("home"), preexec_fn=limit), "home", "ulimit -f")

    @skipping.skip_unless(IS_ROOT, "MOUNT", "only root can mount")
    def test_nothing_can_be_written(self):
        script = self.path("script")
        with open(script, "w") as file:  # the test's own folder stays in sight, elsewhere
            file.write(f"mount --bind {self.tmp} /mnt && cd /mnt || exit 99\n"
                       "for folder in /tmp /var/tmp /dev/shm; do mount -t tmpfs -o ro tmpfs $folder || exit 99; done\n"
                       'exec "$@"\n')
        arguments = ["/mnt/sherd", "fracture", "/mnt/ball.obj", "-o", "/mnt/" + os.path.basename(self.folder("out"))]
        environment = {"before": ["unshare", "-m", "sh", script], "HOME": "/nonexistent", "TMPDIR": None}
        result = self.run_sherd(*arguments, "--device", "pocl", **environment)
        if result.returncode == 99:
            skipping.skip(self, "MOUNT", "no tmpfs can be mounted here")
        builtin = self.run_sherd(*arguments, **environment)  # which needs no folder
        self.assertEqual((builtin.returncode, builtin.stderr), (0, ""))
        self.refused(result, "/nonexistent", "HOME", "permission denied", "POCL_CACHE_DIR")


if __name__ == "__main__":
    skipping.main()
