"""Backend of pip install . (PEP 517): calls CMake and packs build/python/grainlaw as a wheel. No package beyond Python's own.

--config-settings build-dir=FOLDER takes a build that is configured already; CMAKE_ARGS in the environment has options for a
new one, which is build/wheel-TAG and stays for the next time."""

import base64
import hashlib
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
TAG = "cp{0}{1}-cp{0}{1}-{2}".format(*sys.version_info[:2], re.sub("[-.]", "_", sysconfig.get_platform()))


def run(*command):
    try:
        subprocess.run(command, check=True, stdout=sys.stderr)
    except (OSError, subprocess.CalledProcessError) as error:
        sys.exit(f"grainlaw: {error}; debian-packages.txt lists what building needs, ./install-packages.sh installs it")


def built(config_settings):
    """The folder of the package, up to date."""
    build = (config_settings or {}).get("build-dir")
    if build is None:
        build = ROOT / "build" / f"wheel-{TAG}"
        generator = ["-G", "Ninja"] if shutil.which("ninja") else []
        run("cmake", "-S", str(ROOT), "-B", str(build), *generator, "-DCMAKE_BUILD_TYPE=Release", "-DBUILD_TESTING=OFF",
            "-DGRAINLAW_PYTHON=ON", f"-DPython_EXECUTABLE={sys.executable}", *shlex.split(os.environ.get("CMAKE_ARGS", "")))
    run("cmake", "--build", str(build), "--parallel", str(os.cpu_count() or 1), "--target", "grainlaw_python")
    return pathlib.Path(build) / "python" / "grainlaw"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    package = built(config_settings)
    version = re.search(r"VERSION (\d+(?:\.\d+)+)", (ROOT / "CMakeLists.txt").read_text().split("project(", 1)[1])[1]
    info = f"grainlaw-{version}.dist-info"
    files = {f"grainlaw/{file.name}": file.read_bytes() for file in sorted(package.iterdir()) if file.is_file()}
    files[f"{info}/METADATA"] = (
        f"Metadata-Version: 2.1\nName: grainlaw\nVersion: {version}\nLicense: BSD-3-Clause\nRequires-Python: >=3.9\n"
        "Summary: From frictionless grains to an incremental constitutive law and back\nRequires-Dist: numpy\n").encode()
    files[f"{info}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: grainlaw\nRoot-Is-Purelib: false\nTag: {TAG}\n".encode()
    digest = lambda data: base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
    record = [f"{name},sha256={digest(data)},{len(data)}\n" for name, data in files.items()]
    files[f"{info}/RECORD"] = "".join(record + [f"{info}/RECORD,,\n"]).encode()
    wheel = f"grainlaw-{version}-{TAG}.whl"
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return wheel


def build_sdist(sdist_directory, config_settings=None):
    raise RuntimeError("there are no source archives for PyPI; the checkout is the source")
