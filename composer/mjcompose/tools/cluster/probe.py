"""The first function sent to a worker. It may lack mjcompose, so this module is sent and imports nothing of it."""

from __future__ import annotations


def versions(packages: tuple[str, ...]) -> dict[str, str]:
    """Return the versions that a model's bytes depend on, besides its sources: mjcompose's code, packages, zlib.

    Packages that are not installed are left out.
    """
    import hashlib
    import importlib.util
    import os
    import re
    import zlib
    from importlib import metadata

    found = {"zlib": zlib.ZLIB_RUNTIME_VERSION}
    for name in packages:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    spec = importlib.util.find_spec("mjcompose")
    if spec is None or spec.origin is None:
        return found
    package, digest = os.path.dirname(spec.origin), hashlib.sha256()
    for folder, folders, names in os.walk(package):
        folders.sort()
        for name in sorted(names):
            if name.endswith(".py"):
                with open(os.path.join(folder, name), "rb") as file:
                    digest.update(name.encode() + hashlib.sha256(file.read()).digest())
    with open(os.path.join(package, "base", "__init__.py"), encoding="utf-8") as file:
        written = re.findall(r'^__version__ = "(.+)"$', file.read(), re.MULTILINE)
    found["mjcompose"] = f"{' '.join(written)} ({digest.hexdigest()[:16]})"
    return found
