"""What goes wrong when a bundle is loaded or asked for a name."""

from __future__ import annotations

from composer.diagnostics.failure import MjcomposeError


class LoadError(MjcomposeError):
    """A bundle that cannot be loaded, or is not what its manifest says."""


class UnknownNameError(MjcomposeError, KeyError):
    """A name that a model does not have; the message lists what there is. A KeyError too."""


class BundleWarning(UserWarning):
    """Something about a bundle that need not be wrong: the model was verified by another MuJoCo, for instance."""
