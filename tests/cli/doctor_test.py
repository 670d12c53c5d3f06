#!/usr/bin/python3
"""`sherd doctor`: what it reports of a machine that is well, and of machines that are not.

SHERD_BIN names the program.
"""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import unittest

import skipping
from cli_test import SCHEMA, SHERD
from kernel_cache_test import AS_NOBODY, DRIVER, USER

MODULE = os.environ.get("SHERD_FAULTS")
SECTIONS = {"driver_folder": str, "drivers": list, "platforms": list, "self_test": dict, "versions": dict, "machine": dict,
            "memory": dict, "kernel_cache": dict, "temporary_folder": dict, "assimp": dict, "environment": dict,
            "problems": list, "device_works": bool}


class Doctor(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.home = tempfile.mkdtemp(prefix="sherd-doctor-home-")  # kernels are compiled once for all tests
        os.chmod(cls.home, 0o777)
        cls.addClassCleanup(shutil.rmtree, cls.home)

    def setUp(self):
        self.tmp = tempfile.mkdtemp(prefix="sherd-doctor-")
        os.chmod(self.tmp, 0o777)
        self.addCleanup(shutil.rmtree, self.tmp)

    def path(self, name, text=None):
        path = os.path.join(self.tmp, name)
        if text is not None:
            with open(path, "w") as file:
                file.write(text)
        return path

    def run_doctor(self, *arguments, program=SHERD, before=(), stdout=subprocess.PIPE, **variables):
        given = {"PATH": os.environ["PATH"], "OCL_ICD_VENDORS": DRIVER, "HOME": self.home, "TMPDIR": self.tmp, **variables}
        return subprocess.run([*before, program, "doctor", *arguments], stdout=stdout, stderr=subprocess.PIPE, text=True,
                              timeout=400, cwd="/", env={k: v for k, v in given.items() if v is not None})

    def report(self, status, device="auto", **more):
        """The JSON object, which has every section; the text has the same problems."""
        result = self.run_doctor("--device", device, "--json", **more)
        self.assertEqual(result.returncode, status, result.stderr)
        report = json.loads(result.stdout)
        self.assertEqual((report["schema"], report["command"]), (SCHEMA, "doctor"))
        for section, kind in SECTIONS.items():
            self.assertIsInstance(report[section], kind, section)
        self.assertEqual(report["device_works"], status == 0)
        if status == 0:
            self.assertEqual(result.stderr, "")
        else:
            self.assertRegex(result.stderr, r"\Asherd: no device works[^\n]*\n\Z")
        text = self.run_doctor("--device", device, **more)
        self.assertEqual((text.returncode, text.stderr), (status, result.stderr))
        self.assertEqual(text.stdout.endswith("All is well.\n"), not report["problems"], text.stdout)
        for problem in report["problems"]:
            self.assertRegex(problem, r"\A[^\n]{8,}[^\n.]\Z")
            self.assertIn(f"  - {problem}.\n", text.stdout)
        return report, text.stdout

    @staticmethod
    def open_cl(report):
        return [platform for platform in report["platforms"] if platform["name"] != "builtin"]

    def wrong(self, report, *words):
        """One problem has all of these words."""
        self.assertTrue(any(all(word in problem for word in words) for problem in report["problems"]), report["problems"])

    def test_a_machine_that_is_well(self):
        report, text = self.report(0)
        self.assertEqual(report["problems"], [])
        self.assertEqual(report["self_test"]["fault"], None)
        self.assertIs(report["self_test"]["right"], True)
        devices = [device for platform in report["platforms"] for device in platform["devices"]]
        self.assertEqual(sum(device["chosen"] for device in devices), 1)
        self.assertTrue(any(driver["fault"] is None for driver in report["drivers"]))
        self.assertEqual(report["kernel_cache"]["folder"], os.path.join(self.home, ".cache/pocl/kcache"))
        self.assertEqual(report["kernel_cache"]["chosen_by"], "HOME")
        self.assertEqual((report["assimp"]["reads"], report["temporary_folder"]["folder"]), (True, self.tmp))
        version = subprocess.run([SHERD, "--version"], stdout=subprocess.PIPE, text=True).stdout.split()[1]
        self.assertEqual(report["versions"]["sherd"], version)
        self.assertLess(0, report["memory"]["max_memory_default_bytes"])
        self.assertEqual(report["versions"]["opencl"], "in this build")
        builtin = next(platform["devices"] for platform in report["platforms"] if platform["name"] == "builtin")
        self.assertEqual(report["versions"]["built_in_kernels"].split(", by ")[0],
                         ", ".join(device["name"] for device in builtin))
        for fact in (version, report["versions"]["openvdb"], report["versions"]["system"], report["assimp"]["program"],
                     devices[0]["name"], report["kernel_cache"]["folder"], report["drivers"][0]["library"]):
            self.assertIn(fact, text)

    def test_only_variables_that_matter(self):
        report, text = self.report(0, SECRET_TOKEN="hush", POCL_MAX_PTHREAD_COUNT="2")
        self.assertNotIn("hush", text + json.dumps(report))
        self.assertEqual(report["environment"], {"HOME": self.home, "TMPDIR": self.tmp, "OCL_ICD_VENDORS": DRIVER,
                                                 "POCL_MAX_PTHREAD_COUNT": "2"})

    def test_no_driver(self):
        empty = self.path("vendors")
        os.mkdir(empty)
        report, _ = self.report(4, "pocl", OCL_ICD_VENDORS=empty)
        self.assertEqual((report["drivers"], self.open_cl(report), report["driver_folder"]), ([], [], empty))
        self.wrong(report, "no driver is installed", empty, "pocl-opencl-icd")
        report, _ = self.report(0, OCL_ICD_VENDORS=empty)  # the built-in device needs none
        self.assertEqual(report["problems"], [])
        self.assertEqual(report["self_test"]["device"].split(" / ")[0], "builtin")

    def test_a_driver_without_its_library(self):
        vendors = self.path("vendors")
        os.mkdir(vendors)
        file = self.path("vendors/gone.icd", "libgone.so.7\n")
        report, text = self.report(4, "pocl", OCL_ICD_VENDORS=vendors)
        self.assertEqual([driver["library"] for driver in report["drivers"]], ["libgone.so.7"])
        self.wrong(report, file, "libgone.so.7", "No such file")
        self.assertNotIn("no driver is installed", text)
        # beside a driver that works it is a problem still, but no fault of the machine
        shutil.copy("/etc/OpenCL/vendors/pocl.icd", self.path("vendors/pocl.icd"))
        report, _ = self.report(0, OCL_ICD_VENDORS=vendors)
        self.wrong(report, file, "libgone.so.7", "No such file")

    def test_a_driver_that_is_none(self):
        vendors = self.path("vendors")
        os.mkdir(vendors)
        self.path("vendors/c.icd", "libc.so.6\n")
        self.wrong(self.report(4, "pocl", OCL_ICD_VENDORS=vendors)[0], "c.icd", "no OpenCL driver")

    def test_a_device_that_is_not_here(self):
        result = self.run_doctor("--device", "no-such-device", "--json")
        self.assertEqual(result.returncode, 4)
        self.wrong(json.loads(result.stdout), "no-such-device", "devices here: ")

    def test_no_folder_for_kernels(self):
        report, _ = self.report(4, "pocl", POCL_CACHE_DIR="/proc/cache")
        self.assertEqual(report["kernel_cache"]["folder"], None)
        self.wrong(report, "/proc/cache", "POCL_CACHE_DIR")

    @skipping.skip_unless(os.path.exists("/etc/OpenCL/vendors/rusticl.icd"), "RUSTICL", "needs mesa-opencl-icd")
    def test_a_platform_without_devices(self):
        report, _ = self.report(4, "rusticl", OCL_ICD_VENDORS="rusticl.icd")  # without RUSTICL_ENABLE it has none
        self.assertEqual([(platform["devices"], platform["fault"]) for platform in self.open_cl(report)], [([], "it has no device")])

    def test_nobody_without_a_home(self):
        program = self.path("bin")
        os.mkdir(program)
        for name in ("sherd", "sherd-assimp"):
            os.chmod(shutil.copy2(os.path.join(os.path.dirname(SHERD), name), program), 0o755)
        program = os.path.join(program, "sherd")
        report, _ = self.report(0, program=program, before=AS_NOBODY, HOME=None)
        self.assertEqual(report["problems"], [])
        self.assertEqual(report["kernel_cache"]["folder"], os.path.join(self.tmp, f"sherd-cache-{USER}"))
        self.assertEqual(report["kernel_cache"]["chosen_by"], "TMPDIR")
        report, _ = self.report(0, program=program, before=AS_NOBODY, HOME="/proc/home")
        self.wrong(report, "/proc/home/.cache", "HOME")

    def test_without_the_program_that_reads_fbx(self):
        program = shutil.copy2(SHERD, self.path("sherd"))
        report, _ = self.report(0, program=program)
        self.assertEqual((report["assimp"]["program"], report["assimp"]["reads"]), (None, False))
        self.assertIn(self.path("sherd-assimp"), report["assimp"]["tried"])
        self.wrong(report, "FBX and DAE files cannot be read", "sherd-assimp")

    def test_a_program_that_reads_fbx_and_fails(self):
        fails = self.path("fails", "#!/bin/sh\nexit 3\n")
        os.chmod(fails, 0o755)
        report, _ = self.report(0, SHERD_ASSIMP=fails)
        self.assertEqual((report["assimp"]["program"], report["assimp"]["reads"]), (fails, False))
        self.wrong(report, "FBX and DAE files cannot be read", "Assimp")

    def test_no_folder_for_temporary_files(self):
        report, _ = self.report(0, TMPDIR="/proc/absent")
        self.assertIs(report["temporary_folder"]["writable"], False)
        self.wrong(report, "/proc/absent", "TMPDIR")

    @skipping.skip_unless(MODULE, "FAULTS", "SHERD_FAULTS names the module that lets calls fail")
    def test_a_driver_that_ends_the_process(self):
        # as PoCL's compiler does where it cannot write; the first file is PoCL's own
        report, _ = self.report(4, "pocl", LD_PRELOAD=MODULE, SHERD_FAULT="write", SHERD_FAULT_AT="2", SHERD_FAULT_ERROR="28",
                                SHERD_FAULT_BELOW=self.path("cache"), POCL_CACHE_DIR=self.path("cache"))
        self.wrong(report, "No space left on device")
        self.assertTrue(report["drivers"] and self.open_cl(report))

    @skipping.skip_unless(MODULE, "FAULTS", "SHERD_FAULTS names the module that lets calls fail")
    def test_no_memory_to_look(self):
        # a hundred drivers whose long paths are copied; the program itself copies less
        vendors = os.path.join(self.tmp, *["v" * 200] * 15)
        os.makedirs(vendors)
        for number in range(100):
            pathlib.Path(vendors, f"{number}.icd").touch()
        result = self.run_doctor("--device", "pocl", "--json", LD_PRELOAD=MODULE, SHERD_FAULT="memory", SHERD_FAULT_AT="150",
                                 SHERD_FAULT_BYTES="3000", OCL_ICD_VENDORS=vendors)
        self.assertEqual(result.returncode, 4, result.stderr)
        report = json.loads(result.stdout)
        # libstdc++ 12 reads a folder's next name in a function that may not throw: there the process ends by signal 6
        self.wrong(report, "the process that examines the OpenCL devices ended with", "not enough memory")
        self.assertEqual(report["drivers"], [])

    def test_standard_output_full(self):
        with open("/dev/full", "w") as full:
            result = self.run_doctor(stdout=full)
        self.assertEqual(result.returncode, 5)
        self.assertIn("standard output", result.stderr)

    def test_interrupted(self):
        """Also where the other process hangs."""
        hangs = self.path("hangs", "#!/bin/sh\nexec sleep 1000\n")
        os.chmod(hangs, 0o755)
        started = subprocess.Popen([SHERD, "doctor"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env={**os.environ, "SHERD_ASSIMP": hangs, "HOME": self.home})
        children = pathlib.Path(f"/proc/{started.pid}/task/{started.pid}/children")
        while "sleep\n" not in [pathlib.Path(f"/proc/{child}/comm").read_text() for child in children.read_text().split()]:
            self.assertIsNone(started.poll())
        started.send_signal(signal.SIGTERM)
        said, _ = started.communicate(timeout=60)
        self.assertEqual((started.returncode, said), (130, ""))


if __name__ == "__main__":
    skipping.main()
