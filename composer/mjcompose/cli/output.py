"""Writing and reporting the models of `build`."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import asdict, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Severity, hide
from mjcompose.base.naming import file_name
from mjcompose.base.report import as_lines, json_text
from mjcompose.base.scratch import scratch
from mjcompose.base.sink import Sink
from mjcompose.base.words import counted
from mjcompose.bundle.bundle import (
    WORLDS,
    Bundle,
    Location,
    OutputError,
    OutputForm,
    form_of,
    hash_of,
    is_address,
    license_table,
    location,
    picture_of,
    report_unlicensed,
)
from mjcompose.bundle.staging import check_is_no_source, check_own_place, manifest_beside, staged_file, with_version
from mjcompose.cli.reporting import clear_progress, note_files, note_output, progress, say, say_details
from mjcompose.sources.context import Context
from mjcompose.text.expression import shown
from mjcompose.tree.merged_settings import in_words

if TYPE_CHECKING:
    from mjcompose.cli.run import Run
    from mjcompose.mujoco.engine import Session
    from mjcompose.pipeline.cache.builder import BuildResult, Maker
    from mjcompose.text.node import Node

_KEPT = "picture"


def picture_beside(target: str, name: str) -> Path:
    return Path(os.path.dirname(target.rstrip("/"))) / picture_of(name)


class Picturing(Struct, frozen=False):
    """Draws the pictures in one child process with a renderer, which ends with `opened`."""

    opened: ExitStack
    _session: Session | None = field(default=None)

    def put(self, target: str, name: str, *, is_known: bool, context: Context) -> None:
        """Draw the picture of the output `target`; if the output `is_known`, an existing picture stays."""
        out = picture_beside(target, name)
        with context.sink:
            check_own_place(context.folder / out)
        if context.sink.has_errors:
            return
        if is_known and os.path.exists(context.folder / out):
            return
        from mjcompose.mujoco.engine import Session
        from mjcompose.sides.operand import read_operand
        from mjcompose.sides.side import load
        from mjcompose.tools.view.render import RenderRequest, render

        if self._session is None:
            self._session = self.opened.enter_context(Session(rendering=True))
        with ExitStack() as opened:
            operand = read_operand(target, replace(context, sink=Sink()), opened)
            side = None if operand is None else load(operand, _KEPT, self._session)
            if operand is None or side is None:
                context.sink.error("no-rendering", f"no picture of `{target}` can be made: it cannot be read")
            else:
                render(_KEPT, out, RenderRequest(), context=context, session=self._session, option="--picture")


class OutputSpec(Struct):
    """The form and place of an output, and its report; `picturing` draws a picture next to it.

    The name of a `derived` output comes from the model, not from the user.
    """

    out: str
    kind: OutputForm
    verified: bool
    form: str
    why: bool = False
    licenses: bool = False
    picturing: Picturing | None = None
    derived: bool = False

    def target(self, name: str, mujoco: str | None) -> str:
        """Return the output of a model, by its name and the version of MuJoCo that compiled it."""
        target = self.out.replace("{name}", file_name(name)).replace("{hash}", hash_of(name))
        if self.kind != "mjb":
            return target

        return with_version(target, mujoco)

    def place(self, folder: Path, name: str, mujoco: str | None) -> Location | None:
        """Return the output of a model as a place, or None for standard output."""
        return None if self.out == "-" else location(folder, self.target(name, mujoco))

    def elsewhere(self, folder: Path) -> OutputSpec:
        """Return the same output for a process that runs in another folder, without pictures."""
        slash = "/" if self.out.endswith("/") and not is_address(self.out) else ""
        return replace(self, picturing=None, out=f"{location(folder, self.out)}{slash}")

    @property
    def assets_above(self) -> int:
        """The number of levels from a model's folder up to the folder of shared assets."""
        return 2 if os.path.basename(os.path.dirname(self.out.rstrip("/"))) == "{hash}" else 1

    def text_beside(self, folder: Path) -> Path | None:
        """Return the folder from which text refers to its files, if the output is only text."""
        if self.kind != "text":
            return None
        return folder if self.out == "-" else Path(os.path.abspath(folder / self.out)).parent


def kind_of_output(out: str | None, models: int = 1) -> OutputForm:
    """Return the form for OUT. Raises OutputError if it is unclear, or if several models would get the same path."""
    if out is None:
        return OutputForm.ARCHIVE
    kind = OutputForm.TEXT if out == "-" else form_of(out)
    known = {"{name}", "{hash}", "{mujoco}"} if kind == "mjb" else {"{name}", "{hash}"}
    unknown = next((word for word in _PLACEHOLDER.findall(out) if word not in known), None)
    if unknown:
        help = f"write {' or '.join(f'`{word}`' for word in sorted(known))}, or remove the braces"
        raise OutputError("output-kind", f"`{unknown}` has no meaning in the output `{out}`", help)
    if is_address(out) and kind in (OutputForm.TEXT, OutputForm.USD):
        help = "write a bundle, such as `{name}.zip`"
        raise OutputError("output-kind", f"`{out}` cannot be an address: {_NO_ADDRESS[kind]}", help)
    if models > 1 and "{name}" not in out:
        folder = out if out.endswith("/") else f"{out}/"
        help = f"write for instance `-o '{folder}{{name}}/'` or `-o '{folder}{{name}}.zip'`"
        raise OutputError("output-kind", f"several models cannot all be `{out}`", help)
    return kind


_PLACEHOLDER = re.compile(r"\{\w+\}")
_NO_ADDRESS = {
    "text": "text alone names files of this machine",
    "usd": "USD is written by MuJoCo's converter, to this machine",
}


def report_of(result: BuildResult, spec: OutputSpec) -> str:
    out = hide(spec.target(result.name, result.mujoco))
    if spec.form == "json":
        return json_text(_data(result, spec, out))
    return as_lines(_lines(result, spec, out))


def _data(result: BuildResult, spec: OutputSpec, out: str) -> dict[str, object]:
    sizes = dict(result.sizes or {})
    answer: dict[str, object] = {"output": out, "name": result.name, "sha256": result.sha256, "sizes": sizes}
    if result.merged:
        answer["merged"] = {kind: dict(names) for kind, names in result.merged.items()}
    adopted = [each for each in result.adopted if each.is_written]
    if adopted:
        answer["adopted"] = [{"setting": each.setting, "value": each.value, "parts": each.parts} for each in adopted]
    if result.excluded:
        answer["excluded"] = result.excluded
    if result.replaced:
        answer["replaced"] = dict(result.replaced)
    if spec.licenses:
        answer["licenses"] = [asdict(row) for row in result.licenses]
    if spec.picturing is not None:
        answer["picture"] = picture_of(result.name)
    if spec.why:
        answer["built"] = result.is_new
        answer["why"] = list(result.why)
    return answer


def _lines(result: BuildResult, spec: OutputSpec, out: str) -> Iterator[str]:
    files = out
    be = "is"
    if spec.kind == "mjb":
        files = f"{out} and {manifest_beside(Path(out)).name}"
        be = "are"
    yield f"{files} {be} up to date" if result.is_written else f"wrote {files}"
    sizes = result.sizes or {}
    if sizes:
        bodies = counted(sizes["nbody"] - 1, "body")
        sensors = counted(sizes["nsensor"], "sensor")
        numbers = f"nq {sizes['nq']}, nv {sizes['nv']}, nu {sizes['nu']}, {bodies}, {sensors}"
        yield f"  {result.name}: {numbers}, {counted(sizes['nkey'], 'keyframe')}"
    else:
        yield "  not verified: MuJoCo has not compiled it"
    if spec.picturing is not None:
        yield f"  picture {picture_of(result.name)}"
    yield from remarks(result, spec)
    yield f"  contents sha256 {result.sha256}"
    if spec.licenses and not result.licenses:
        yield "  no licenses: it takes nothing from other models"
    elif spec.licenses:
        yield from license_table(result.licenses)


def remarks(result: BuildResult, spec: OutputSpec) -> Iterator[str]:
    """Yield one line each for adopted settings, the replaced output, merged assets, and the reason for a build."""
    yield from (f"  adopted {words}" for words in in_words(result.adopted))
    if result.excluded:
        pairs = counted(result.excluded, "pair")
        yield f"  excluded {pairs} of bodies from colliding: `mjcompose plan` names them"
    if result.replaced:
        values = ", ".join(f"{name} = {shown(value)}" for name, value in result.replaced.items())
        recipe = result.replaced.get("recipe")
        yield f"  replaced the model of {recipe}" if recipe else f"  replaced the model with {values}"
    if result.merged:
        counts = ", ".join(counted(len(names), kind) for kind, names in result.merged.items())
        yield f"  merged {counts} into equal ones: the manifest and `--output-format json` list the merged names"
    if spec.why:
        if result.is_new:
            yield from (f"  built: {line}" for line in result.why)
        else:
            yield from (f"  not built again: {line}" for line in result.why or ("nothing that it depends on changed",))


class Task(Struct):
    """One run of `build`: the workers, the outputs, and the values of parameters."""

    maker: Maker
    spec: OutputSpec
    run: Run
    given: dict[str, Node] = field(default_factory=dict)
    session: Session | None = None

    def build_one(self, why: tuple[str, ...]) -> int:
        from mjcompose.pipeline.cache.builder import ModelChoice

        maker = self.maker
        choice = ModelChoice(self.given)
        assert self.session is not None
        progress(f"building {maker.recipe}")
        return self.finish(maker.make(self.run.context, self.session, choice, key=maker.key(), why=why))

    def finish(self, result: BuildResult | None) -> int:
        from mjcompose.pipeline.cache.builder import shown_input_files

        run = self.run
        spec = self.spec
        context = self.run.context
        files = shown_input_files(result, context)
        note_files(files)
        if result is not None:
            result = put(result, self.maker, context, session=self.session, spec=spec)
        if result is not None:
            add_picture(result, spec, context)
        run.to_stderr = spec.out == "-"
        run.report()
        say_details(context, files)
        if result is None or context.sink.has_errors:
            return run.code_of_failure(self.maker.recipe)
        note_output(spec.target(result.name, result.mujoco))
        if run.to_stderr:
            for line in remarks(result, spec):
                say(line, err=True)
        else:
            say(report_of(result, spec), form=run.form)
        return 0


def put(
    result: BuildResult, maker: Maker, context: Context, session: Session | None, spec: OutputSpec
) -> BuildResult | None:
    """Write a model to its output; return it as written, or None after an error, which is reported."""
    return _Writer(maker, spec, context, session=session).put(result)


def add_picture(result: BuildResult, spec: OutputSpec, context: Context) -> None:
    """Draw a picture next to a written model with `--picture`. Report errors to the context."""
    if spec.picturing is not None:
        target = spec.target(result.name, result.mujoco)
        spec.picturing.put(target, result.name, is_known=result.is_written, context=context)


class _Writer(Struct):
    maker: Maker
    spec: OutputSpec
    context: Context
    session: Session | None

    def put(self, result: BuildResult) -> BuildResult | None:
        maker = self.maker
        spec = self.spec
        context = self.context
        clear_progress()
        report_unlicensed(result.licenses, context)
        self._judge_warnings(result)
        if context.strict and context.sink.has_errors:
            return None
        target = spec.target(result.name, result.mujoco)
        try:
            self._check_picture(result, target)
            if spec.kind == "text" and result.built is not None:
                from mjcompose.bundle.alone import text_alone

                composed = result.built.composed
                text = text_alone(composed.model, composed.files, target, folder=context.folder)
                result = maker.with_text(result, text, context)
            if not result.is_written:
                from mjcompose.bundle.write import origin_of_output

                out = location(context.folder, target)
                before = None if spec.kind in ("text", "usd") else origin_of_output(out)
                maker.note_written(result, self._write(result, target))
                now = None if before is None else origin_of_output(out)
                if before is not None and now is not None:
                    result = replace(result, replaced=before.other_than(now))
        except OutputError as error:
            context.sink.add(error.diagnostic)
            return None
        self._judge_warnings(result)
        return result

    def _check_picture(self, result: BuildResult, target: str) -> None:
        if self.spec.picturing is not None:
            from mjcompose.pipeline.cache.builder import input_files

            message = "--picture"
            check_is_no_source(self.context.folder / picture_beside(target, result.name), message, input_files(result))

    def _judge_warnings(self, result: BuildResult) -> None:
        """Drop warnings that the recipe allows; with `--strict` the rest become errors."""
        context = self.context
        for diagnostic in context.sink.diagnostics:
            if diagnostic.severity is not Severity.ERROR and diagnostic.code in result.allowed:
                context.sink.drop(diagnostic)
        if context.strict:
            context.sink.promote()

    def _write(self, result: BuildResult, out: str) -> tuple[Path, ...]:
        """Write the model, and return the files that were written to other places than `out`."""
        from mjcompose.pipeline.cache.builder import input_files

        maker = self.maker
        spec = self.spec
        context = self.context
        if spec.kind in ("text", "mjb", "usd") and result.bundle is not None:
            _check_holds_all(result.bundle, out)
        if out != "-":
            if is_address(out):
                self._deliver(result, out)
                return ()
            check_is_no_source(context.folder / out, "-o", input_files(result))
            if spec.derived:
                check_own_place(context.folder / out)
        if spec.kind == "text":
            text = result.text
            assert text is not None
            if out != "-":
                with staged_file(context.folder / out, "-o") as stage:
                    stage.write_bytes(text)
            elif sys.stdout is None:
                raise OSError("standard output is closed")
            else:
                sys.stdout.buffer.write(text)
                sys.stdout.buffer.flush()
        elif spec.kind == "folder with shared assets":
            from mjcompose.bundle.remote import write_shared

            assert result.bundle is not None
            return write_shared(result.bundle, Path(os.path.abspath(context.folder / out)), spec.assets_above)
        elif result.packed and result.record is not None:
            from mjcompose.bundle.write import write_packed

            packed = result.packed
            model = result.record.model
            write_packed(packed, model, Path(out), environment=context.environment, packed=packed.__getitem__)
        else:
            from mjcompose.bundle.write import write

            def lost(warning: str) -> None:
                context.sink.warning("usd-loss", f"`{out}` is not the whole model: {warning}")

            assert result.bundle is not None
            write(
                result.bundle,
                out,
                environment=context.environment,
                session=self.session,
                packing=maker.packing,
                warn=lost,
            )
            if spec.kind == "mjb":
                return (manifest_beside(Path(os.path.abspath(context.folder / out))),)
        return ()

    def _deliver(self, result: BuildResult, out: str) -> None:
        from mjcompose.bundle.remote import ASSETS, deliver_assets, deliver_file, deliver_folder

        parts = out.rstrip("/").rsplit("/", self.spec.assets_above)
        with scratch("output") as folder:
            models = folder / "models"
            local = models.joinpath(*parts[1:])
            self._write(result, f"{local}/" if out.endswith("/") else str(local))
            if os.path.isdir(models / ASSETS):
                deliver_assets(models / ASSETS, f"{parts[0]}/{ASSETS}")
            if os.path.isdir(local):
                deliver_folder(local, out.rstrip("/"))
                return
            for each in sorted(local.parent.iterdir(), key=lambda each: each == local):
                deliver_file(each, f"{out.rpartition('/')[0]}/{each.name}")


def _check_holds_all(bundle: Bundle, out: str) -> None:
    if WORLDS in bundle.files:
        help = "write a folder or an archive, such as `-o build/{name}.zip`"
        raise OutputError("output-kind", f"`{out}` cannot store the worlds", help)
