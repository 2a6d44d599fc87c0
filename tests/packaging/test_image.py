"""What is shipped: the image's recipe, the dependencies' reasons, the public names."""

import io
import json
import re
import socket
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from dockerfile_parse import DockerfileParser

from tools import tool

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


@pytest.fixture(scope="module")
def dockerfile() -> DockerfileParser:
    return DockerfileParser(fileobj=io.BytesIO((ROOT / "Dockerfile").read_bytes()))


@pytest.fixture(scope="module")
def values(dockerfile: DockerfileParser) -> dict[str, str]:
    return {entry["instruction"]: entry["value"] for entry in dockerfile.structure}


def test_the_dockerfile_has_no_finding():
    hadolint = Path(sys.executable).with_name("hadolint")
    done = subprocess.run([hadolint, ROOT / "Dockerfile"], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "")


def test_every_path_that_the_image_copies_exists_and_is_not_ignored(dockerfile):
    kept = set(re.findall(r"^!(\S+)", (ROOT / ".dockerignore").read_text(), re.MULTILINE))
    sources = [
        source
        for entry in dockerfile.structure
        if entry["instruction"] == "COPY" and "--from" not in entry["value"]
        for source in entry["value"].split()[:-1]
    ]
    assert sources
    for source in sources:
        assert (ROOT / source).exists(), source
        assert source in kept, source


def test_the_image_runs_as_nobody_special_on_a_base_named_by_its_digest(dockerfile, values):
    assert values["USER"] == "10001"
    assert values["WORKDIR"] != "/app"
    assert json.loads(values["ENTRYPOINT"]) == ["tini", "--"]
    bases = {e["value"].split()[0] for e in dockerfile.structure if e["instruction"] == "FROM"}
    (base,) = bases
    assert re.fullmatch(r"python:3\.11-slim-bookworm@sha256:[0-9a-f]{64}", base)


def test_the_health_check_of_the_image_fails_unless_the_reply_is_200(values):
    command = json.loads(values["HEALTHCHECK"].partition(" CMD ")[2])
    tool(command[0])
    for status, code in ((b"200 OK", 0), (b"503 Service Unavailable", 1)):
        with socket.create_server(("127.0.0.1", 0)) as listening:
            port = str(listening.getsockname()[1])
            asking = subprocess.Popen([word.replace("8000", port) for word in command])
            connection, _ = listening.accept()
            with connection, connection.makefile("rb") as request:
                assert request.readline() == b"GET /healthz HTTP/1.1\r\n"
                assert request.readline().startswith(b"Host: ")
                connection.sendall(b"HTTP/1.1 " + status + b"\r\n\r\n")
                assert asking.wait() == code


def test_the_image_installs_what_the_service_needs_by_hashes():
    text = (ROOT / "requirements-image.txt").read_text()
    entry = r"^([\w.-]+)==(\S+)((?: \\\n    --hash=sha256:[0-9a-f]{64})+)\n"
    versions = {name: version for name, version, _ in re.findall(entry, text, re.M)}
    assert len(versions) == len(re.findall(r"^\w.*==", text, re.M))
    constraints = (ROOT / "constraints.txt").read_text().lower().replace("_", "-").splitlines()
    for name, version in versions.items():
        assert any(line.startswith(f"{name}=={version}") for line in constraints), name
    extras = PROJECT["optional-dependencies"]
    asked = [*PROJECT["dependencies"], *extras["plot"], *extras["serve"], *extras["postgres"]]
    for name in (re.split(r"[<>=\[]", name)[0].lower() for name in asked):
        assert name in versions
    assert not {"pyarrow", "obstore", "pip"} & versions.keys()


def test_every_dependency_has_a_pinned_version():
    pinned = re.findall(r"^(\S+)==", (ROOT / "constraints.txt").read_text(), re.MULTILINE)
    pinned = {"vibrafeed", *(name.lower().replace("_", "-") for name in pinned)}
    extras = PROJECT["optional-dependencies"]
    names = [*PROJECT["dependencies"], *extras["plot"], *extras["serve"], *extras["dev"]]
    assert {re.split(r"[<>=\[]", name)[0].lower() for name in names} <= pinned


def test_the_repository_names_no_registry():
    """Every address in it is one of these, and no setting points a client at an index."""
    known = {
        "json-schema.org", "www.w3.org", "www.apache.org", "www.opengis.net", "docs.ogc.org",
        "docs.xarray.dev", "pint-xarray.readthedocs.io", "developers.google.com", "docs.dask.org",
        "distributed.dask.org",
    }  # fmt: skip
    # Published coefficients name the pages that they come from, published libraries their homes.
    sources = [":!core/materials/*.toml", ":!docs/generated/friction.md"]
    sources += [":!app/page/vendor"]
    # written in pieces, so that the search does not find itself
    bare = "index.ur[l]|" + "py" + r"pi\.org|python" + "hosted"
    done = subprocess.run(
        [tool("git"), "grep", "-nIohE", f"[a-z]+://[A-Za-z0-9.{{-]+|{bare}", "--", ".", *sources],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    found = {line.partition(":")[2] for line in done.stdout.splitlines()}
    hosts = {address.partition("://")[2] or address for address in found}
    assert "www.apache.org" in hosts  # the licence: the search finds what is there
    # .example is set aside for examples, and a bucket of an object store is no host
    nowhere = ("127.0.0.1", "localhost", "bucket", "lab", "host", "vibrafeed-scheduler", "{tmp")
    assert {h for h in hosts if not h.startswith(nowhere) and not h.endswith(".example")} <= known
