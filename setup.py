"""pip install .: CMake builds the compiled part for the interpreter that asks, setuptools packs it.

The environment variable CMAKE_ARGS is passed on to CMake. GRAINFIELD_BUILD_DIR names a build folder to use, and to keep:
what is built there is not built again. What the build needs is in scripts/dependencies.txt.
"""
import os
import pathlib
import re
import shlex
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent


class CMakeBuild(build_ext):
    def build_extension(self, ext):
        built = pathlib.Path(self.get_ext_fullpath(ext.name)).resolve()
        folder = pathlib.Path(os.environ.get("GRAINFIELD_BUILD_DIR") or self.build_temp).resolve()
        jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL") or str(os.cpu_count() or 1)
        subprocess.run(["cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                        "-DGRAINFIELD_TESTS=OFF", "-DGRAINFIELD_PYTHON=ON", f"-DPython_EXECUTABLE={sys.executable}",
                        *shlex.split(os.environ.get("CMAKE_ARGS", ""))], check=True)
        subprocess.run(["cmake", "--build", folder, "--target", "_grainfield", "-j", jobs], check=True)
        built.parent.mkdir(parents=True, exist_ok=True)
        self.copy_file(str(folder / "python" / "grainfield" / built.name), str(built))


version = re.search(r"project\(grainfield VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
setup(version=version, ext_modules=[Extension("grainfield._grainfield", sources=[])], cmdclass={"build_ext": CMakeBuild})
