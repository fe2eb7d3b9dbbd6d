"""Errors and warnings of loading a bundle and looking up names."""

from __future__ import annotations

from composer.diagnostics.failure import MjcomposeError


class LoadError(MjcomposeError):
    """A bundle that cannot be loaded, or does not match its manifest."""


class UnknownNameError(MjcomposeError, KeyError):
    """A name that a model does not have; the message lists the existing names. Also a KeyError."""


class BundleWarning(UserWarning):
    """A possible problem of a bundle, for instance that another version of MuJoCo verified the model."""
