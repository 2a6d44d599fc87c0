"""Who is let in, what is refused, and what a hostile request meets."""

import asyncio
import json
import signal
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import anyio
import pytest
import uvicorn
from fastapi.testclient import TestClient
from typer.testing import CliRunner

from access import BEARER, HASH, KEY, give_key
from local_client import client_of, local_client
from posted_sweeps import STUDY, problem
from vibrafeed.app.cli import app as commands
from vibrafeed.app.jobs.keys import new_key
from vibrafeed.app.settings import TEST_SWITCHES, Settings
from vibrafeed.app.web import server
from vibrafeed.app.web.guard import is_loopback
from vibrafeed.app.web.observe import SAFE
from waiting import EVERY, PATIENCE

OTHER_KEY, _ = new_key()
OPEN = ["/", "/page/page.css", "/healthz", "/readyz", "/docs", "/page/docs.js", "/openapi.json",
        "/static-offline-docs/swagger-ui.css"]  # fmt: skip
POSTS = ["/sweeps", "/processes/simulate/execution", "/processes/optimise/execution"]


class TestKeys:
    @pytest.fixture
    def client(self, tmp_path: Path) -> TestClient:
        give_key(tmp_path)
        give_key(tmp_path, OTHER_KEY)
        return client_of(tmp_path)

    @pytest.mark.parametrize("path", ["/docs", "/healthz", "/vibrafeed"])
    def test_a_path_of_a_proxy_opens_nothing(self, client, path):
        """The guard judges what the routes see, whatever stands before it."""
        behind = local_client(client.app, root_path=path)
        assert behind.get(f"{path}/healthz").status_code == 200
        problem(behind.get(f"{path}/jobs"), 401, "key")
        assert behind.get(f"{path}/jobs", headers=BEARER).status_code == 200

    def test_every_documented_route_but_the_open_ones_needs_a_key(
        self, client, without_studies, tmp_path
    ):
        document = client.get("/openapi.json").json()
        assert document["security"] == [{"bearer": []}, {"header": []}]
        guarded = 0
        for path, operations in document["paths"].items():
            for method, told in operations.items():
                reply = client.request(method, path.replace("{", "").replace("}", ""))
                if path in OPEN:
                    assert reply.status_code != 401
                    assert told["security"] == []
                    assert "401" not in told["responses"]
                else:
                    guarded += 1
                    problem(reply, 401, "key")
                    assert reply.headers["www-authenticate"] == "Bearer"
                    assert "security" not in told
                    assert "401" in told["responses"]
        assert guarded >= 10
        document = client_of(tmp_path / "without").get("/openapi.json").json()
        assert document["security"] == [{}, {"bearer": []}, {"header": []}]

    def test_what_is_not_documented_needs_one_too(self, client):
        for path in ("/nowhere", "/docs2", "/healthz/", "/docsx/"):
            problem(client.get(path), 401, "key")
        for path in ("/sweeps/../healthz", "//healthz", "/HEALTHZ"):
            assert asked(client.app, path, server=None)[0] == 401
        assert asked(client.app, "/docs/../scenes", server=None)[0] == 404  # open, and nowhere
        assert client.head("/sweeps/x/netcdf").status_code == 401
        assert client.options("/sweeps").status_code == 401

    def test_open_paths_need_none(self, client, without_studies):
        for path in OPEN:  # whether it is ready, an app that was not started may well deny
            expected = (200, 503) if path == "/readyz" else (200,)
            assert client.get(path).status_code in expected

    @pytest.mark.parametrize(
        "headers",
        [
            BEARER,
            {"Authorization": f"bearer  {KEY}"},
            {"X-API-Key": KEY},
            {"X-API-Key": OTHER_KEY},
            {"X-API-Key": KEY, "Authorization": "Basic eDp5"},
        ],
    )
    def test_a_key_lets_in(self, client, headers):
        assert client.get("/scenes", headers=headers).status_code == 200

    @pytest.mark.parametrize(
        "headers",
        [
            {},
            {"Authorization": KEY},
            {"Authorization": f"Basic {KEY}"},
            {"Authorization": "Bearer "},
            {"Authorization": f"Bearer {KEY}x"},
            {"Authorization": f"Bearer {KEY[:-1]}"},
            {"Authorization": f"Bearer {HASH}"},
            {"X-API-Key": ""},
            {"X-API-Key": HASH},
            {"X-API-Key": KEY, "Authorization": f"Bearer {KEY}x"},
            {"X-API-Key": "\u00e9".encode()},
            {"Cookie": f"key={KEY}"},
        ],
    )
    def test_nothing_else_does(self, client, headers):
        reply = client.get("/scenes", headers=headers)
        problem(reply, 401, "key")
        assert KEY not in reply.text
        assert HASH not in reply.text

    def test_with_keys_the_service_has_any_name(self, client):
        reply = client.get("/scenes", headers={**BEARER, "Host": "lab.example:8000"})
        assert reply.status_code == 200
        for host in ("[::", "a b", "x/y", "a:b:c", "lab.example:8000@evil"):
            problem(client.post("/sweeps", headers={**BEARER, "Host": host}), 400, "host")


class TestWithoutKeys:
    @pytest.mark.parametrize("host", ["localhost", "LOCALHOST:80", "127.0.0.1:8000", "[::1]:8000"])
    def test_this_machine_is_answered(self, tmp_path, host):
        assert client_of(tmp_path).get("/scenes", headers={"Host": host}).status_code == 200

    @pytest.mark.parametrize(
        "host",
        ["evil.example", "127.0.0.1.evil.example", "localhost.evil.example:8000", "127.0.0.2", "",
         "testserver",
         "[::2]:80", "0.0.0.0:8000"],
    )  # fmt: skip
    def test_another_name_is_refused_even_if_it_leads_here(self, tmp_path, host):
        client = client_of(tmp_path)
        for path in ("/scenes", "/healthz", "/docs"):
            problem(client.get(path, headers={"Host": host}), 403, "no-keys")

    @pytest.mark.parametrize(
        ("address", "status"),
        [
            (("10.0.0.5", 80), 403),
            (("0.0.0.0", 80), 403),
            (("fe80::1", 80), 403),
            (("::ffff:10.0.0.5", 80), 403),
            (("127.0.0.1", 80), 200),
            (("127.8.9.10", 80), 200),
            (("::1", 80), 200),
            (("::ffff:127.0.0.1", 80), 200),
            (("/run/vibrafeed.sock", None), 200),
            (None, 200),
        ],
    )
    def test_the_socket_decides_whatever_started_the_app(self, tmp_path, address, status):
        assert asked(client_of(tmp_path).app, "/scenes", server=address)[0] == status
        give_key(tmp_path)
        header = [(b"authorization", f"Bearer {KEY}".encode())]
        keyed = asked(client_of(tmp_path).app, "/scenes", server=address, headers=header)
        assert keyed[0] == 200

    @pytest.mark.parametrize(
        ("host", "expected"),
        [("127.0.0.1", True), ("::1", True), ("localhost", True), ("0.0.0.0", False), ("::", False),
         ("", False), ("192.168.1.5", False), ("lab.example", False), ("127.1", False)],
    )  # fmt: skip
    def test_loopback(self, host, expected):
        assert is_loopback(host) is expected


def asked(app: Any, path: str, *, server: Any, headers: Any = ()) -> tuple[int, bytes]:
    """Ask an app without any client; return status and body."""
    scope = {
        "type": "http", "asgi": {"version": "3.0"}, "http_version": "1.1", "method": "GET",
        "path": path, "raw_path": path.encode(), "query_string": b"", "scheme": "http",
        "headers": [(b"host", b"localhost"), *headers], "server": server,
        "client": ("127.0.0.1", 1),
    }  # fmt: skip
    sent: list[Any] = []

    async def receive() -> Any:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Any) -> None:
        sent.append(message)

    anyio.run(app, scope, receive, send)
    return sent[0]["status"], b"".join(message.get("body", b"") for message in sent[1:])


ELSEWHERE = {"Origin": "https://lab.example"}


class TestOrigins:
    @pytest.mark.parametrize("origin", ["https://evil.example", "null", "http://127.0.0.1:81", ""])
    def test_another_page_may_not_change_anything(self, tmp_path, origin):
        client = client_of(tmp_path)
        problem(client.post("/sweeps", json=STUDY, headers={"Origin": origin}), 403, "origin")
        problem(client.delete("/sweeps/x", headers={"Origin": origin}), 403, "origin")
        reply = client.get("/scenes", headers={"Origin": origin})
        assert reply.status_code == 200
        assert "access-control-allow-origin" not in reply.headers
        own = client.post("/sweeps", json=STUDY, headers={"Origin": "http://127.0.0.1"})
        assert own.status_code == 201

    def test_named_origins_may(self, tmp_path):
        give_key(tmp_path)
        client = client_of(tmp_path, cors_origins="https://lab.example")
        allowed = client.options(
            "/sweeps",
            headers={
                **ELSEWHERE,
                "Access-Control-Request-Method": "POST",
                "Access-Control-Request-Headers": "authorization, content-type",
            },
        )
        assert allowed.status_code == 200
        assert allowed.headers["access-control-allow-origin"] == "https://lab.example"
        assert "access-control-allow-credentials" not in allowed.headers
        reply = client.post("/sweeps", json=STUDY, headers={**ELSEWHERE, **BEARER})
        assert reply.status_code == 201
        assert "X-Request-ID" in reply.headers["access-control-expose-headers"]
        # A page must be able to read why it was refused.
        refused = client.get("/scenes", headers=ELSEWHERE)
        problem(refused, 401, "key")
        assert refused.headers["access-control-allow-origin"] == "https://lab.example"


def test_every_reply_has_safe_headers(tmp_path):
    client = client_of(tmp_path)
    client.app.add_api_route("/fails", fail)
    replies = [
        client.get("/healthz"),
        client.get("/nowhere"),
        client.delete("/scenes"),
        client.post("/sweeps", content=b"x"),
        client.get("/scenes", headers={"Host": "evil.example"}),
        client.get("/fails"),
        client.post("/sweeps", content=b" " * 2_000_000),
        client.get("/docs"),
        client.get("/static-offline-docs/swagger-ui.css"),
    ]
    assert [reply.status_code for reply in replies] == [200, 404, 405, 422, 403, 500, 413, 200, 200]
    for reply in replies:
        for name, value in SAFE.items():
            assert reply.headers.get_list(name) == [value]
        assert "server" not in reply.headers
        policy = reply.headers["content-security-policy"]
        assert policy.startswith("default-src 'none'; ")
        assert "frame-ancestors 'none'" in policy
        assert "unsafe" not in policy
        assert ("script-src" in policy) == (reply.request.url.path.startswith(("/docs", "/static")))


def fail() -> None:
    raise RuntimeError("secret words")


class TestLimits:
    def test_requests_under_way_are_limited_of_an_address_and_of_all(self, tmp_path):
        app = client_of(tmp_path, max_requests=8).app
        held, go = threading.Semaphore(0), threading.Event()

        async def wait() -> dict[str, str]:
            held.release()
            while not go.is_set():
                await asyncio.sleep(EVERY)
            return {}

        app.add_api_route("/wait", wait)
        app.add_api_route("/fails", fail)
        one, two, three = (local_client(app, client=(f"10.0.0.{n}", 1)) for n in (1, 2, 3))
        for _ in range(9):  # what has failed is not counted for ever
            assert one.get("/fails").status_code == 500
        with ThreadPoolExecutor(8) as threads:
            asked = [threads.submit(one.get, "/wait") for _ in range(6)]
            for _ in range(6):
                assert held.acquire(timeout=PATIENCE)
            assert one.get("/scenes").status_code == 429
            assert "vibrafeed_requests_under_way 7.0" in two.get("/metrics").text
            asked += [threads.submit(two.get, "/wait") for _ in range(2)]
            for _ in range(2):
                assert held.acquire(timeout=PATIENCE)
            reply = three.get("/scenes")
            go.set()
        problem(reply, 503, "busy")
        assert reply.headers["retry-after"] == "1"
        assert {one.result().status_code for one in asked} == {200}
        assert "vibrafeed_requests_under_way 1.0" in one.get("/metrics").text

    @pytest.mark.parametrize("path", POSTS)
    def test_a_large_body_is_refused_before_it_is_read(self, tmp_path, path):
        client = client_of(tmp_path, max_body_bytes=1000)
        for length in ("1001", "50000000", "9" * 30, "0" * 30 + "1001"):
            problem(client.post(path, content=b"", headers={"Content-Length": length}), 413, "body")
        # Without a length it is counted as it comes; that of a GET is ignored.
        problem(client.post(path, content=iter([b" " * 600] * 2)), 413, "body")
        assert client.request("GET", "/scenes", content=b"x" * 1001).status_code == 200


DEEP = 100_000


@pytest.mark.parametrize(
    ("body", "words"),
    [
        (b'{"kind": NaN}', "NaN"),
        (b'{"title": 1e400}', "1.8e308"),
        (b'{"a": [1, -1e400]}', "1.8e308"),
        (b'{"a": 1' + b"0" * 400 + b"}", "1.8e308"),
        (b"[" * DEEP, "objects and lists"),
        (b'{"a":' * DEEP, "objects and lists"),
        (b"[" * 40 + b"]" * 40, "deep"),
        (b"[" * 900 + b"]" * 900, "deep"),
        (b'{"kind": ' + b"[" * 500 + b"]" * 500 + b"}", "deep"),
        (b'{"frequency": 1, "frequency": 2}', "'frequency' appears twice"),
        (b'{"\\ud800": 1, "\\ud800": 2}', "'\\ud800' appears twice"),
        (b"\xff\xfe{}", "utf-8"),
        (b'{"title": "\xed\xa0\x80"}', "utf-8"),
        ('{"title": "x"}'.encode("utf-16"), "utf-8"),
        (b'{"title": "a\\u0000b"}', "NUL"),
        (b'{"title": "\\ud800"}', "half"),
        (b'{"a": {"\\udc00": 1}}', "invalid character"),
        (b"[]", "not a table"),
        (b"3", "not a table"),
        (b'"' + b"x" * 900_000 + b'"', "not a table"),
        (b"{" + b",".join(b'"k%d":1' % i for i in range(50_000)) + b"}", "50,000 keys"),
    ],
)
def test_a_hostile_body_gets_a_problem_that_names_it(tmp_path, body, words):
    client = client_of(tmp_path)
    for path in POSTS:
        reply = client.post(path, content=body)
        document = problem(reply, 422, "study")
        assert words in " ".join(error["message"] for error in document["errors"])
        assert len(reply.content) < 100_000


def test_a_tricky_path_gets_a_problem(tmp_path):
    client = client_of(tmp_path)
    for path in (
        "/sweeps/..%2f..%2fetc%2fpasswd",
        "/sweeps/%00",
        "/sweeps/%ed%a0%80/netcdf",
        "/sweeps/" + "a" * 60_000,
        "/sweeps/" + "0" * 64 + "%00/slice?output=a&axes=b",
        "/sweeps/x/zarr/..%2f..%2fstudy.json",
        "/sweeps/x/zarr/%00",
        "/scenes/..%2fnowhere",  # clients tidy it to /nowhere
        "/scenes/%00",
        "/static-offline-docs/..%2f..%2fcore.py",
        "/static-offline-docs/%00",
        "/static-offline-docs/" + "a" * 5000,
        "/%2e%2e/%2e%2e/etc/passwd",
    ):
        reply = client.get(path)
        assert reply.status_code in (404, 422), path
        assert reply.headers["content-type"] == "application/problem+json"


@pytest.mark.parametrize(
    ("url", "status"),
    [
        ("http://localhost/scenes", 200),
        ("HTTP://127.0.0.1:8000/scenes", 200),
        ("https://localhost", 200),
        ("http://evil.example/scenes", 403),
        ("http://localhost/nowhere", 404),
        ("http://lab@localhost/scenes", 400),
    ],
)
def test_the_host_of_an_absolute_form_is_that_of_the_url(tmp_path, url, status):
    """Requests as clients send them to proxies, which servers have to take, too (RFC 9112)."""
    assert asked(client_of(tmp_path).app, url, server=("127.0.0.1", 80))[0] == status
    give_key(tmp_path)
    assert asked(client_of(tmp_path).app, "http://localhost/scenes", server=None)[0] == 401


@pytest.mark.parametrize("query", ["a=" + 8_200 * "1", 256 * "a=1&", 256 * "&"])
def test_a_query_that_is_long_to_read_is_not_read(tmp_path, query, monkeypatch):
    """With 5,000 names in each of 64 queries others waited for a minute."""
    client = client_of(tmp_path)
    monkeypatch.setattr("starlette.requests.QueryParams", None)
    problem(client.get(f"/scenes?{query}"), 414, "query")
    monkeypatch.undo()
    assert client.get("/scenes?" + "&".join(255 * ["a=1"])).status_code == 200


class TestSettings:
    @pytest.mark.parametrize("text", ["https://a.example,http://b.example", '["https://a.example", "http://b.example"]',
                                      " https://a.example , http://b.example,"])  # fmt: skip
    def test_origins_are_a_list_in_json_or_between_commas(self, monkeypatch, text):
        monkeypatch.setenv("VIBRAFEED_CORS_ORIGINS", text)
        assert Settings().cors_origins == ("https://a.example", "http://b.example")
        monkeypatch.setenv("VIBRAFEED_CORS_ORIGINS", "")
        assert Settings().cors_origins == ()

    @pytest.mark.parametrize(
        ("name", "value", "words"),
        [
            ("VIBRAFEED_API_KEY_HASHES", KEY, "`vibrafeed key add`"),
            ("VIBRAFEED_CORS_ORIGINS", '["https://lab.example"', "JSON list"),
            ("VIBRAFEED_CORS_ORIGINS", '[["https://lab.example"]]', "Correct"),
            ("VIBRAFEED_CORS_ORIGINS", "*", "not a web origin"),
            ("VIBRAFEED_CORS_ORIGINS", "https://lab.example/", "not a web origin"),
            ("VIBRAFEED_MAX_REQUESTS", "0", "greater than 0"),
            ("VIBRAFEED_MAX_REQUEST", "9", "Did you mean 'VIBRAFEED_MAX_REQUESTS'?"),
            ("VIBRAFEED_RESULTS_URL", "s3://bucket", "kept in VIBRAFEED_DATA_DIRECTORY alone"),
            ("vibrafeed_api_key", KEY, "vibrafeed has no setting"),
            ("VIBRAFEED_MAX_UNSENT_BYTES", "9", "a proxy holds slow readers"),
        ],
        ids=lambda text: "secret" if KEY in text else None,  # it differs between processes
    )
    def test_a_wrong_setting_is_named_and_secrets_are_not_echoed(
        self, monkeypatch, name, value, words
    ):
        monkeypatch.setenv(name, value)
        result = CliRunner().invoke(commands, ["serve", "--show-settings"])
        assert result.exit_code == 2
        assert name in result.output
        assert words in result.output
        assert KEY not in result.output

    def test_the_service_refuses_to_open_itself_without_keys(self, tmp_path, monkeypatch):
        monkeypatch.setenv("VIBRAFEED_DATA_DIRECTORY", str(tmp_path))  # whoever runs it has keys
        for host in ("0.0.0.0", "::", "lab.example"):
            result = CliRunner().invoke(commands, ["serve", "--host", host])
            assert result.exit_code == 2
            assert "vibrafeed key add" in result.output

    def test_every_setting_is_shown_and_described(self, monkeypatch):
        for name in TEST_SWITCHES:
            monkeypatch.setenv(name, "1")
        result = CliRunner().invoke(commands, ["serve", "--show-settings"])
        shown = json.loads(result.output)
        assert set(shown) == set(Settings.model_fields)
        assert all(field.description for field in Settings.model_fields.values())


def test_a_signal_tells_the_app_before_connections_are_waited_for(tmp_path, monkeypatch):
    monkeypatch.setattr(server, "_after", lambda seconds, call: None)  # it would end this process
    client = client_of(tmp_path)
    process = server.Server(uvicorn.Config(client.app, log_config=None))
    process.handle_exit(signal.SIGTERM, None)
    assert client.app.state.stopping.is_set()
    assert process.should_exit
    problem(client.get("/readyz"), 503, "not-ready")
