"""What pyproject.toml cannot say: two roots of packages, and the page as data of the first."""

from setuptools import find_packages, setup

PAGE = "thetascope.frontend"  # in a wheel; in a checkout it is the folder frontend/

setup(
    packages=[*find_packages("backend"), *find_packages("shared"), PAGE],
    package_dir={"": "backend", "thetascope_schemas": "shared/thetascope_schemas", PAGE: "frontend"},
    package_data={"thetascope.library": ["*/*.yaml"], "thetascope.report": ["*.css", "*.js"], PAGE: ["**/*"]},
    include_package_data=False,
)
