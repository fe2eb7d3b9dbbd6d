"""Physics that run on the server for an open page."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from threading import Event, Lock, Thread
from typing import Any

from composer import engine
from composer.compiled.stepping import advance as simulate
from composer.view.workshop import KEPT, Workshop

_RATE = 30
_MOST_SECONDS = 0.2
"""For one frame, on this machine: a model that takes longer plays slowly."""
State = dict[str, Any]


def advance(mujoco: Any, model: Any, asked: Mapping[str, Any]) -> State:
    """Simulate some ``seconds`` from a state with qpos, qvel, act, ctrl and time.

    The answer says why if it `stopped`. Missing values come from the keyframe ``key``, or from the reference
    configuration. Runs under `composer.engine.call`.
    """
    data = mujoco.MjData(model)
    key = asked.get("key", -1)
    if 0 <= key < model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, key)
    for name in ("qpos", "qvel", "act", "ctrl"):
        value = asked.get(name)
        array = getattr(data, name)
        if value is not None and len(value) == len(array):
            array[:] = value
    data.time = asked.get("time", 0.0)
    begun = data.time
    stopped = simulate(mujoco, model, data, end=asked["seconds"], begun=begun, most=_MOST_SECONDS)
    if stopped is not None:
        return {"stopped": stopped}
    return {name: getattr(data, name).tolist() for name in ("qpos", "qvel", "act")} | {
        "time": float(data.time)
    }


class Physics:
    """Simulates on request; `send` is called with each configuration."""

    def __init__(self, workshop: Workshop, send: Callable[[State], None]) -> None:
        self.workshop, self.send = workshop, send
        self._going, self._stop, self._lock = Event(), Event(), Lock()
        self._state: State = {}
        self._version = -1
        self._thread = Thread(target=self._run, daemon=True)
        self._thread.start()

    def play(self, playing: bool, state: State, stopped: str | None = None) -> None:
        """Start from a state of the page, or pause; `stopped` says why the simulation cannot go on."""
        with self._lock:
            if playing:
                self._state, self._version = dict(state), self.workshop.shown.version
                self._going.set()
            else:
                self._going.clear()
            self.send({"playing": playing} | ({} if stopped is None else {"stopped": stopped}))

    def control(self, ctrl: list[float]) -> None:
        """Set new controls while it runs."""
        self._state = {**self._state, "ctrl": ctrl}

    def close(self) -> None:
        self._stop.set()
        self._going.set()

    def _run(self) -> None:
        while True:
            self._going.wait()
            if self._stop.is_set():
                return
            started = time.monotonic()
            self._advance()
            time.sleep(max(0.0, 1 / _RATE - (time.monotonic() - started)))

    def _advance(self) -> None:
        with self.workshop.lock:
            if self.workshop.shown.version != self._version:
                self.play(False, {})  # another model, to which the state does not apply
                return
            asked = {**self._state, "seconds": 1 / _RATE}
            answer = engine.call(self.workshop.session, advance, [KEPT], argument=asked)
        stopped = answer.value.get("stopped") if answer.ok else f"MuJoCo has stopped: {answer.error}"
        if stopped is not None:
            self.play(False, {}, stopped)
            return
        with self._lock:
            if self._going.is_set():  # otherwise it was paused meanwhile, which every page knows
                self._state = {**self._state, **answer.value}
                self.send({"playing": True, "qpos": answer.value["qpos"], "version": self._version})
