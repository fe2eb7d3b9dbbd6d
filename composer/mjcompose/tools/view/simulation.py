"""The physics of the model that a server shows: it runs, pauses, steps, and goes back over the last seconds."""

from __future__ import annotations

import json
import time
import zlib
from bisect import bisect_right
from collections import deque
from collections.abc import Callable, Mapping
from threading import Event, Lock, Thread
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.mujoco import engine
from mjcompose.mujoco.controls import advance as simulate
from mjcompose.mujoco.scene import look, pull, seen
from mjcompose.tools.view.builder import KEPT, Workshop

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjData, MjModel

_RATE = 30
_MOST_SECONDS = 0.2  # for one frame: a model that takes longer plays slowly
SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0)
State = dict[str, Any]
_ARRAYS = ("qpos", "qvel", "act", "ctrl", "mocap_pos", "mocap_quat")


def advance(mujoco: Any, model: MjModel, asked: Mapping[str, Any]) -> State:
    """Simulate some ``seconds``, or a single step without them, from a state with `_ARRAYS` and time.

    If it `stopped`, the answer has the reason, and `warned` has MuJoCo's warnings by their kind. Missing values come
    from the keyframe ``key``, or from the reference configuration. Runs under `mjcompose.mujoco.engine.call`.
    """
    data = mujoco.MjData(model)
    key = asked.get("key", -1)
    if 0 <= key < model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, key)
    for name in _ARRAYS:
        value = asked.get(name)
        array = getattr(data, name)
        if value is not None and len(value) == array.size:
            array[:] = np.reshape(value, array.shape)
    data.time = asked.get("time", 0.0)
    pull(mujoco, model, data, asked=asked.get("pull") or {})
    # Half of a step more is one step: the time may be a little less than a multiple of the timestep.
    end = asked.get("seconds", 0.5 * model.opt.timestep)
    stopped = simulate(mujoco, model, data, end=end, begun=data.time, most=_MOST_SECONDS)
    if stopped is not None:
        return {"stopped": stopped}
    state = {name: getattr(data, name).ravel().tolist() for name in _ARRAYS} | {"time": float(data.time)}
    return state | {"seen": seen(mujoco, model, data), "warned": _warnings(mujoco, data)}


def _warnings(mujoco: Any, data: MjData) -> dict[str, str]:
    """Return the text of each kind of warning that MuJoCo has counted."""
    return {
        kind.name: mujoco.mju_warningText(int(kind), int(data.warning[int(kind)].lastinfo))
        for kind in mujoco.mjtWarning.__members__.values()
        if kind.name != "mjNWARNING" and data.warning[int(kind)].number
    }


class Past:
    """The states of the last seconds, compressed, of limited size. The newest state is always there."""

    def __init__(self, seconds: float = 10.0, size: int = 50_000_000) -> None:
        self.seconds = seconds
        self.size = size
        self._kept: deque[tuple[float, bytes]] = deque()
        self._total = 0

    def add(self, state: State) -> None:
        """Keep a state. States that are later in time are forgotten: the physics went on from an earlier one."""
        while self._kept and self._kept[-1][0] >= state["time"]:
            self._total -= len(self._kept.pop()[1])
        content = zlib.compress(json.dumps(state).encode(), 1)
        self._kept.append((state["time"], content))
        self._total += len(content)
        while len(self._kept) > 1 and (self._kept[-1][0] - self._kept[0][0] > self.seconds or self._total > self.size):
            self._total -= len(self._kept.popleft()[1])

    def at(self, moment: float) -> State | None:
        """Return the last state that is not after a time, or the first one; None if there is none."""
        if not self._kept:
            return None
        number = max(0, bisect_right([time for time, _ in self._kept], moment + 1e-9) - 1)
        found: State = json.loads(zlib.decompress(self._kept[number][1]))
        return found

    @property
    def range(self) -> list[float] | None:
        """The first and the last time, or None."""
        return [self._kept[0][0], self._kept[-1][0]] if self._kept else None

    def clear(self) -> None:
        self._kept.clear()
        self._total = 0


class Simulation:
    """Simulates on request; `send` is called with each configuration.

    All pages show the same simulation: a page that joins gets its state from `now`. `_turn` counts the requests of
    pages, so the answer to an older request cannot overwrite a newer one.
    """

    def __init__(self, workshop: Workshop, send: Callable[[State], None]) -> None:
        self.workshop = workshop
        self.send = send
        self.past = Past()
        self.speed = 1.0
        self._going = Event()
        self._stop = Event()
        self._lock = Lock()
        self._turn = 0
        self._state: State = {}
        self._heard: set[str] = set()
        self._version = -1
        self._thread = Thread(target=self._run, daemon=True)
        self._thread.start()

    # -- requests of a page ----------------------------------------------------------------------------------------

    def play(self, playing: bool, state: State, more: State | None = None) -> None:
        """Start from a state of the page, or pause. `more` goes to the pages: why it pauses.

        If the state has the pose at which it was paused, the simulation goes on from there with its velocities.
        """
        with self._lock:
            self._turn += 1
            if playing:
                self._take(state)
                self._going.set()
            else:
                self._going.clear()
            self.send({"playing": playing, **(more or {})})

    def step(self, state: State) -> None:
        """Simulate one step from a state of the page, and pause."""
        with self._lock:
            self._turn += 1
            turn = self._turn
            self._take(state)
            self._going.clear()
            self.send({"playing": False})
        self._advance(turn, {})

    def reset(self, key: int) -> None:
        """Go back to the time 0 of a keyframe, or of the reference configuration for -1; keep running if it runs."""
        with self._lock:
            self._turn += 1
            self._start({"key": key})
            self.send({**self._flags, "version": self._version, "key": key})

    def back(self, moment: float) -> None:
        """Pause, and show a state of the last seconds again."""
        with self._lock:
            self._turn += 1
            self._going.clear()
            state = self.past.at(moment)
            if state is not None and self.workshop.shown.version == self._version:
                self._state = state
                self.send(self._shown())

    def change_speed(self, speed: float) -> None:
        """Let `speed` seconds of physics pass in a second."""
        if speed in SPEEDS:
            self.speed = speed
            self.send(self._flags)

    def update(self, state: State) -> None:
        """Change the controls, or the pull at a body until the next request; without points, nothing is pulled."""
        self._state = {**self._state, **state}

    def look(self, version: int, asked: State) -> None:
        """Send contacts, tendons and sensors of a pose, with the `looked` of the page that asks."""
        with self.workshop.lock:
            if version == self.workshop.shown.version:
                answer = engine.call(self.workshop.session, look, [KEPT], argument=asked)
                if answer.ok:
                    self.send({"looked": asked["looked"], "version": version, "seen": answer.value})

    def now(self) -> State | None:
        """Return the state for a page that joins, or None if nothing has been simulated with this model."""
        with self._lock:
            has_run = self.past.range is not None and self.workshop.shown.version == self._version
            return self._shown() if has_run else None

    def close(self) -> None:
        self._stop.set()
        self._going.set()

    # -- the state -------------------------------------------------------------------------------------------------

    @property
    def _flags(self) -> State:
        return {"playing": self._going.is_set(), "speed": self.speed}

    def _shown(self) -> State:
        """Return the state as the pages get it."""
        names = ("qpos", "ctrl", "time", "seen")
        shown = {name: self._state[name] for name in names if name in self._state}
        return {**self._flags, "version": self._version, **shown, "kept": self.past.range}

    def _take(self, state: State) -> None:
        is_same = self._version == self.workshop.shown.version and self._state.get("qpos") == state["qpos"]
        if is_same and "time" in self._state:
            self._state = {**self._state, "ctrl": state["ctrl"]}
        else:
            self._start(state)

    def _start(self, state: State) -> None:
        self._state = dict(state)
        self._version = self.workshop.shown.version
        self._heard.clear()
        self.past.clear()

    # -- the thread ------------------------------------------------------------------------------------------------

    def _run(self) -> None:
        while True:
            self._going.wait()
            if self._stop.is_set():
                return
            started = time.monotonic()
            self._advance(self._turn, {"seconds": self.speed / _RATE})
            time.sleep(max(0.0, 1 / _RATE - (time.monotonic() - started)))

    def _advance(self, turn: int, more: State) -> None:
        """Simulate once, unless a page asks for something else meanwhile."""
        with self.workshop.lock:
            if self.workshop.shown.version != self._version:
                self.play(False, {})  # another model, to which the state does not apply
                return
            answer = engine.call(self.workshop.session, advance, [KEPT], argument={**self._state, **more})
        stopped = answer.value.get("stopped") if answer.ok else f"MuJoCo has stopped: {answer.error}"
        if stopped is not None:
            self.play(False, {}, {"stopped": stopped})
            return
        warned = answer.value.pop("warned")
        with self._lock:
            if turn != self._turn:
                return
            changed: State = {name: self._state[name] for name in ("ctrl", "pull") if name in self._state}
            self._state = {**self._state, **answer.value, **changed}
            self.past.add({name: value for name, value in self._state.items() if name != "pull"})
            new = [text for kind, text in warned.items() if kind not in self._heard]
            self._heard |= set(warned)
            if new:
                self._going.clear()
            self.send(self._shown() | ({"warned": new} if new else {}))
