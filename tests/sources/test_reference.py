from __future__ import annotations

import pytest
from mjcompose.sources.kinds import kind_called, parse
from mjcompose.sources.reference import Reference, SourceError


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("./parts/table.xml", ("path", "", "./parts/table.xml", "")),
        ("../arm.yaml", ("path", "", "../arm.yaml", "")),
        ("arm.xml", ("path", "", "arm.xml", "")),
        ("/opt/robots/arm.xml", ("path", "", "/opt/robots/arm.xml", "")),
        ("./odd:name.xml", ("path", "", "./odd:name.xml", "")),
        (r"C:\robots\arm.xml", ("path", "", r"C:\robots\arm.xml", "")),
        ("package:robots/arms/a.xml", ("package", "robots", "arms/a.xml", "")),
        ("package:robots.arms/a.xml", ("package", "robots.arms", "a.xml", "")),
        ("menagerie:robotiq_2f85", ("menagerie", "robotiq_2f85", "", "")),
        ("menagerie:robotiq_2f85/2f85", ("menagerie", "robotiq_2f85", "2f85", "")),
        ("descriptions:ur5e_mj_description", ("descriptions", "ur5e_mj_description", "", "")),
        ("s3://lab/a/b.zip#m/x.xml", ("bucket", "s3://lab/a/b.zip", "m/x.xml", "")),
        (f"gs://lab/b.zip@sha256:{'0' * 64}#x.xml", ("bucket", "gs://lab/b.zip", "x.xml", "0" * 64)),
        (f"oci:ghcr.io/lab/arm_v2@sha256:{'0' * 64}#x.xml", ("oci", "ghcr.io/lab/arm_v2", "x.xml", "0" * 64)),
        ("hf:lab/robots.v2@main#m/x.xml", ("hf", "lab/robots.v2", "m/x.xml", "main")),
        ("hf:datasets/lab/robots@a%40b#x.xml", ("hf", "datasets/lab/robots", "x.xml", "a@b")),
        ("git+https://host/a/repo@v1#m/x.xml", ("git", "https://host/a/repo", "m/x.xml", "v1")),
        ("git+https://host/repo@fix/one#x.xml", ("git", "https://host/repo", "x.xml", "fix/one")),
        ("git+ssh://git@host/repo@v1#x.xml", ("git", "ssh://git@host/repo", "x.xml", "v1")),
        ("git+file:///srv/repo@v1#x.xml", ("git", "file:///srv/repo", "x.xml", "v1")),
        ("git+http://127.0.0.1:80/repo@v1#x.xml", ("git", "http://127.0.0.1:80/repo", "x.xml", "v1")),
        ("http://localhost:80/a.zip#x.xml", ("archive", "http://localhost:80/a.zip", "x.xml", "")),
        (f"https://host/b.zip@sha256:{'0' * 64}#x.xml", ("archive", "https://host/b.zip", "x.xml", "0" * 64)),
        ("https://host/a/b.zip#m/x.xml", ("archive", "https://host/a/b.zip", "m/x.xml", "")),
    ],
)
def test_takes_apart(text: str, expected: tuple[str, str, str, str]) -> None:
    kind, name, path, revision = expected
    row = kind_called(kind)
    assert row is not None
    assert parse(text) == Reference(text, row, name, path, revision)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "empty"),
        ("  ", "empty"),
        ("a\x00.xml", "control character"),
        ("package:", "the package"),
        ("package:robots", "the file inside the package"),
        ("package:robots/", "the file inside the package"),
        ("package:2robots/a.xml", "cannot be a Python package"),
        ("menagerie:", "the robot"),
        ("menagerie:ur5e/", "the entry"),
        ("descriptions:", "does not name a description"),
        ("descriptions:a/b", "does not name a description"),
        ("git+https://host/repo#x.xml", "the revision"),
        ("git+https://me@host/repo@v1#x.xml", "contains a user name"),
        ("https://me@host/b.zip#x.xml", "contains a user name"),
        ("git+ssh://-x@host/repo@v1#x.xml", "contains a user name"),
        (r"https://10.0.0.1\@host/b.zip#x.xml", r"contains a `\`"),
        (r"git+ssh://git@host\x/repo@v1#x.xml", r"contains a `\`"),
        ("https://host/a b.zip#x.xml", "contains white space"),
        ("git+https://host/a\u2028b@v1#x.xml", "contains white space"),
        ("git+https://host:65536/repo@v1#x.xml", "names a host that cannot be one"),
        ("git+https://h%6fst/repo@v1#x.xml", "names a host that cannot be one"),
        ("git+https://host/repo@v1", "the file inside the repository"),
        ("git+https://host@v1#x.xml", "the repository"),
        ("git+https://host/repo@--upload-pack=x#x.xml", "the revision"),
        ("git+https://host/repo@v%001#x.xml", "the revision"),
        ("git+file://host/repo@v1#x.xml", "the repository"),
        ("https://host/b.zip@sha256:12#x.xml", "64 digits"),
        ("https://host/b.zip", "the file inside the archive"),
        ("https://host#x.xml", "the archive"),
        ("http://host/b.zip?token=hush#x.xml", "in `http://host/b.zip?token=…#x.xml`"),
        ("https://me:secret@host/b.zip#x.xml", "`https://me:…@host/b.zip#x.xml` contains a password"),
        ("git+https://me:secret@host/repo@v1#x.xml", "contains a password"),
    ],
)
def test_what_a_form_lacks(text: str, problem: str) -> None:
    with pytest.raises(SourceError) as caught:
        parse(text)
    assert caught.value.code == "source-kind"
    assert problem in caught.value.message


@pytest.mark.parametrize(
    "name",
    [
        *("token", "access_token", "private_token", "api_key", "apikey", "apiKey", "password", "secret", "sig"),
        *("signature", "X-Amz-Signature", "X-Goog-Credential", "Client-Secret", "auth", "%74oken", "AWSAccessKey"),
    ],
)
@pytest.mark.parametrize(
    "address",
    [
        "https://host/b.zip?raw=1&{}=hush&x=2#x.xml",
        f"https://host/b.zip?{{}}=hush@sha256:{'0' * 64}#x.xml",
        "git+https://host/repo?{}=hush@v1#x.xml",
    ],
)
def test_a_secret_in_a_query_is_refused_and_not_told(address: str, name: str) -> None:
    with pytest.raises(SourceError) as caught:
        parse(address.format(name))
    assert f"{name}=…" in caught.value.message and "contains a secret" in caught.value.message
    assert "hush" not in caught.value.message + str(caught.value.help)


@pytest.mark.parametrize("query", ["raw=1", "design=2", "path=token/a.zip", "author=me", "token=", "v=@v"])
def test_any_other_query_is_taken(query: str) -> None:
    assert parse(f"https://host/b.zip?{query}#x.xml").name == f"https://host/b.zip?{query}"


@pytest.mark.parametrize("token", ["ghp_hush", "github_pat_hush", "glpat-hush"])
def test_a_token_for_a_name_is_refused(token: str) -> None:
    with pytest.raises(SourceError, match="`git[+]https://…@host/repo@v1#x.xml` contains a secret"):
        parse(f"git+https://{token}@host/repo@v1#x.xml")


@pytest.mark.parametrize(
    ("text", "fix"),
    [
        ("menagrie:robotiq_2f85", "write `menagerie:robotiq_2f85`"),
        ("Menagerie:robotiq_2f85", "write `menagerie:robotiq_2f85`"),
        ("packages:robots/a.xml", "write `package:robots/a.xml`"),
        ("git+http://host/b@v1#x.xml", "write `git+https://host/b@v1#x.xml`"),
        ("http://host/b.zip#x.xml", "write `https://host/b.zip#x.xml`"),
        ("package://robots/a.xml", "write `package:robots/a.xml`"),
        ("menagerie://robotiq_2f85", "write `menagerie:robotiq_2f85`"),
        ("odd:name.xml", "if it is a path, write `./odd:name.xml`"),
        ("file:///opt/a.xml", "write the path alone"),
    ],
)
def test_unknown_kinds_say_what_to_write(text: str, fix: str) -> None:
    with pytest.raises(SourceError) as caught:
        parse(text)
    assert caught.value.code == "source-kind"
    assert caught.value.help == fix
