"""The wheel of the package as built: `python3 setup.py bdist_wheel` in build/release/python, see docs/python.md. It needs
the shared libraries of Debian 12 that the module was linked with, so it is a wheel for Debian 12, not for PyPI."""
import re
from pathlib import Path

from setuptools import Distribution, setup

HERE = Path(__file__).parent


class BinaryDistribution(Distribution):
    def has_ext_modules(self) -> bool:
        return True


version = re.search(r'__version__ = "(.*)"', (HERE / "conav" / "__init__.py").read_text())
assert version
setup(
    name="conav",
    version=version.group(1),
    description="Robots, wrong maps, and simulated operators who correct them: environments, models and search",
    license="Apache-2.0",
    python_requires="==3.11.*",
    install_requires=["numpy"],
    packages=["conav"],
    package_data={"conav": ["*.so", "*.pyi", "*.json", "py.typed", "models/*", "config/*"]},
    distclass=BinaryDistribution,
)
