"""Launches from a learning platform, over HTTP with a platform that verifies signatures; and what is refused."""

import hmac
import json
import stat
from base64 import urlsafe_b64encode

import pytest
from joserfc import jwt
from joserfc.jwk import RSAKey

from tests.api.classes import Person, send
from tests.api.conftest import service, until
from tests.api.platform_stub import CLIENT, ENDPOINT, LTI, ROLE, SCORE, Visitor, fetched, new_key, platform
from thetascope.classroom.lti.registry import Platform
from thetascope.classroom.lti.scores import scores_of
from thetascope.classroom.lti.tool_key import FILE, tool_key
from thetascope.server.app import create_app
from thetascope.settings import Settings, SettingsError

ANSWER = {"round": 1, "verdict": "channel", "channel": "gain_loss", "onset": 2.0, "size": 0.1}


@pytest.fixture(scope="module")
def tried(tmp_path_factory):
    """Yield the address of a service, the platform that is registered there, and the folder of its data."""
    folder = tmp_path_factory.mktemp("launches")
    with platform() as stub, service(folder, lti=stub.registered(folder / "platforms.json")) as address:
        stub.tool_keys = f"{address}{LTI}/keys"
        yield address, stub, folder


def taught(visitor: Visitor, **change) -> Person:
    """Open the room of an activity as its teacher does."""
    page = visitor.came(sub="teacher", roles=[f"{ROLE}Instructor"], **change)
    assert page.startswith("/classroom/?launch=")
    status, room = visitor.claim(page, "room")
    assert status == 201, room
    return Person(visitor.tool, "X-Teacher-Token", room["token"], room["code"])


def seated(visitor: Visitor, **change) -> Person:
    """Take the place of a student."""
    page = visitor.came(**change)
    assert page.startswith("/join/?launch=")
    status, joined = visitor.claim(page, "seat")
    assert status == 201, joined
    return Person(visitor.tool, "X-Seat-Token", joined["token"], joined["seat"]["code"])


def test_points_reach_the_gradebook(tried):
    """Login, launch, seat, answer, reveal, score: signed by the tool's key, again after an error of the platform."""
    address, stub, _ = tried
    room = taught(Visitor(address, stub), resource_link={"id": "graded"})
    ada = seated(Visitor(address, stub), resource_link={"id": "graded"})
    eve = seated(Visitor(address, stub), resource_link={"id": "graded"}, sub="eve", custom={"names": "yes"})
    assert ada.code == eve.code == room.code
    assert ada.got("GET", "/seat")["name"] is None and eve.got("GET", "/seat")["name"] == "Ada Lovelace"
    room.got("POST", "/room/rounds", {"kind": "own", "setup": "motor", "seconds": 600})
    until(lambda: ada.ask("PUT", "/seat/answer", ANSWER)[0] == 200)
    stub.refuses.append(503)
    room.got("POST", "/room/reveal")
    until(lambda: stub.scores)
    points = room.got("GET", "/room/wall")["tiles"][0]["outcome"]["points"]
    (score,) = stub.scores
    assert score | {"timestamp": ""} == {
        "userId": "ada",
        "scoreGiven": points,
        "scoreMaximum": 100,
        "activityProgress": "Completed",
        "gradingProgress": "FullyGraded",
        "timestamp": "",
    }
    assert stub.assertions[0]["iss"] == CLIENT and not stub.refuses
    until(lambda: room.got("GET", "/room/wall")["grades"] == {"sent": 1, "waiting": 0, "failed": 0, "why": ""})
    room.got("DELETE", "/room")


def test_the_teacher_sees_what_the_gradebook_did_not_take(tried):
    """A refusal that will not change is not repeated, and stands on the wall with its reason."""
    address, stub, _ = tried
    room = taught(Visitor(address, stub), resource_link={"id": "refused"})
    ada = seated(Visitor(address, stub), resource_link={"id": "refused"})
    room.got("POST", "/room/rounds", {"kind": "own", "setup": "motor", "seconds": 600})
    until(lambda: ada.ask("PUT", "/seat/answer", ANSWER)[0] == 200)
    stub.refuses.append(403)
    room.got("POST", "/room/reveal")
    failed = {"sent": 0, "waiting": 0, "failed": 1, "why": "HTTP 403"}
    until(lambda: room.got("GET", "/room/wall")["grades"] == failed)
    room.got("DELETE", "/room")


def test_whoever_comes_again_is_where_they_were(tried):
    """A second launch returns to the room and to the place; the place of another activity is another."""
    address, stub, _ = tried
    early = Visitor(address, stub)
    page = early.came(resource_link={"id": "again"})
    assert early.claim(page, "seat")[1]["code"] == "lti.no-room"
    room = taught(Visitor(address, stub), resource_link={"id": "again"})
    assert early.claim(page, "seat")[0] == 201
    assert early.claim(page, "seat")[0] == 404  # it was used
    ada = seated(Visitor(address, stub), resource_link={"id": "again"})
    assert ada.got("GET", "/seat")["students"] == 1
    returned = taught(Visitor(address, stub), resource_link={"id": "again"})
    assert returned.code == room.code and room.got("GET", "/room/wall") == returned.got("GET", "/room/wall")
    other = Visitor(address, stub)
    assert other.claim(other.came(resource_link={"id": "elsewhere"}), "seat")[0] == 409
    room.got("DELETE", "/room")
    assert returned.ask("GET", "/room")[0] == ada.ask("GET", "/seat")[0] == 404


def test_a_launch_opens_what_it_is_for_and_nothing_else(tried):
    """A student's opens no room; nobody uses the launch of another browser; the claims are no cross-site forms."""
    address, stub, _ = tried
    ada, eve = Visitor(address, stub), Visitor(address, stub)
    page = ada.came()
    assert ada.claim(page, "room")[0] == 404
    eve.login()
    assert eve.claim(page, "seat")[0] == 404
    for path in ("/room", "/seat", "/keys"):
        assert fetched("POST", f"{address}{LTI}{path}", {}, Origin=stub.address)[0] == 403
    assert fetched("POST", f"{address}/api/classroom", {}, Origin=stub.address)[0] == 403
    status, _, body = fetched("GET", f"{address}{LTI}/keys")
    (key,) = json.loads(body)["keys"]
    assert status == 200 and key["kty"] == "RSA" and not {"d", "p", "q", "dp", "dq", "qi"} & set(key)


REFUSED = {
    "iss": {"iss": "https://evil.example"},
    "aud": {"aud": "another-tool"},
    "azp": {"aud": [CLIENT, "another"], "azp": "another"},
    "exp": {"exp": 1},
    "iat": {"iat": 1},
    "nonce": {"nonce": "guessed"},
    "message_type": {"message_type": "LtiDeepLinkingRequest"},
    "version": {"version": "1.1"},
    "deployment_id": {"deployment_id": "8"},
    "target_link_uri": {"target_link_uri": "https://evil.example/launch"},
    "resource_link.id": {"resource_link": {}},
    "sub": {"sub": None},
    "roles": {"roles": ["http://purl.imsglobal.org/vocab/lis/v2/system/person#Administrator"]},
    "lineitem": {ENDPOINT: {"scope": [SCORE], "lineitem": "http://127.0.0.1:1/items/5"}},
}


def refused(visitor: Visitor, token: str, state: str) -> str:
    """Return the field that the refusal of a launch names."""
    status, _, body = visitor.launch(token, state)
    problem = json.loads(body)
    assert status == 422 and problem["errors"][0]["remedy"], body
    return problem["errors"][0]["field"]


@pytest.mark.parametrize("claim", REFUSED)
def test_a_wrong_claim_is_refused_by_its_name(tried, claim):
    """However well the token is signed."""
    address, stub, _ = tried
    visitor = Visitor(address, stub)
    query = visitor.login()
    token = stub.signed(stub.claims(query, **REFUSED[claim]))
    assert refused(visitor, token, query["state"]) == f"id_token.{claim}"


def unsigned(header: dict, claims: dict) -> str:
    parts = (urlsafe_b64encode(json.dumps(part).encode()).decode().rstrip("=") for part in (header, claims))
    return f"{'.'.join(parts)}."


def confused(header: dict, claims: dict, key: RSAKey) -> str:
    """Return a token whose secret is the public key."""
    text = unsigned(header, claims).rstrip(".")
    mac = hmac.digest(key.as_pem(private=False), text.encode(), "sha256")
    return f"{text}.{urlsafe_b64encode(mac).decode().rstrip('=')}"


def test_a_token_that_the_platform_did_not_sign_is_refused(tried):
    """Another key, none, its public key taken for a secret, a changed text, what is no token, one too long."""
    address, stub, _ = tried
    visitor = Visitor(address, stub)
    for made, field in (
        (lambda claims: stub.signed(claims, new_key()), "signature"),
        (lambda claims: jwt.encode({"alg": "RS256", "kid": "other"}, claims, new_key()), "signature"),
        (lambda claims: unsigned({"alg": "none", "kid": stub.key.kid}, claims), "alg"),
        (lambda claims: unsigned({"alg": "RS256", "kid": stub.key.kid}, claims), "signature"),
        (lambda claims: confused({"alg": "HS256", "kid": stub.key.kid}, claims, stub.key), "alg"),
        (lambda claims: stub.signed(claims)[:-8] + "AAAAAAAA", "signature"),
        (lambda claims: jwt.encode({"alg": "RS256"}, claims, stub.key), "kid"),
    ):
        query = visitor.login()
        assert refused(visitor, made(stub.claims(query)), query["state"]) == f"id_token.{field}"
    for text in ("", "nonsense", "a.b.c", "W10.e30.", stub.signed({"x": "y" * 40_000})):
        assert refused(visitor, text, visitor.login()["state"]) == "id_token"
    status, _, body = visitor.launch("x" * 100_000, visitor.login()["state"])
    assert status == 413, body


def test_a_login_is_used_once_by_the_browser_that_began_it(tried):
    """A state that is replayed, guessed or of another browser is refused; so is the token of another login."""
    address, stub, _ = tried
    ada, eve = Visitor(address, stub), Visitor(address, stub)
    query = ada.login()
    token = stub.signed(stub.claims(query))
    assert ada.launch(token, query["state"])[0] == 303
    assert refused(ada, token, query["state"]) == "state"
    assert refused(ada, token, ada.login()["state"]) == "id_token.nonce"
    assert refused(ada, token, "guessed") == refused(ada, token, "") == "state"
    query = ada.login()
    eve.login()
    for cookie in ("", eve.cookie):
        assert json.loads(eve.launch(stub.signed(stub.claims(query)), query["state"], cookie)[2])["errors"]
        query = ada.login()


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("iss", "https://evil.example"),
        ("client_id", "another"),
        ("lti_deployment_id", "8"),
        ("target_link_uri", "https://evil.example/api/classroom/lti/launch"),
        ("login_hint", ""),
    ],
)
def test_a_login_for_somebody_else_is_refused(tried, field, value):
    """Nobody is sent to an address that is not registered; the refusal names the parameter."""
    address, stub, _ = tried
    form = {"iss": stub.address, "client_id": CLIENT, "login_hint": "h", "target_link_uri": f"{address}{LTI}/launch"}
    status, headers, body = fetched("POST", f"{address}{LTI}/login", form | {field: value}, Origin=stub.address)
    named = "iss" if field == "client_id" else field
    assert status == 422 and json.loads(body)["errors"][0]["field"] == named and "Location" not in headers


def test_without_a_file_there_is_none_of_this(address):
    """The routes say so, and a form of another site is refused like any other."""
    for path in ("/login", "/launch"):
        assert fetched("POST", f"{address}{LTI}{path}", {}, Origin="https://lms.example")[0] == 403
        assert fetched("POST", f"{address}{LTI}{path}", {})[0] == 404
    assert send(address, "GET", f"{LTI}/keys")[1]["code"] == "lti.off"


def test_on_a_service_with_a_key_students_need_none(tmp_path):
    """The room of a teacher does: the sign-in page leads back to the launch."""
    with platform() as stub:
        file = stub.registered(tmp_path / "platforms.json")
        with service(tmp_path, lti=file, host="0.0.0.0", key="a-long-secret-key-for-tests") as address:
            stub.tool_keys = f"{address}{LTI}/keys"
            visitor = Visitor(address, stub)
            page = visitor.came(roles=[f"{ROLE}Instructor"])
            assert visitor.claim(page, "room")[0] == 401
            status, headers, _ = fetched("GET", f"{address}{page}", Accept="text/html")
            assert status == 303 and "launch%3D" in headers["Location"]
            assert visitor.claim(visitor.came(), "seat")[1]["code"] == "lti.no-room"


def test_the_key_is_made_once_and_read_by_its_owner_only(tried, tmp_path):
    """It is in the data folder, and the same after a restart; a damaged one is not replaced."""
    folder = tried[2]
    assert stat.S_IMODE((folder / FILE).stat().st_mode) == 0o600
    assert tool_key(tmp_path).kid == tool_key(tmp_path).kid
    (tmp_path / FILE).write_text("{")
    with pytest.raises(SettingsError):
        tool_key(tmp_path)


ENTRY = {
    "issuer": "https://lms.example",
    "client_id": "1",
    "deployments": ["1"],
    "login_url": "https://lms.example/auth",
    "token_url": "https://lms.example/token",
    "keys_url": "https://lms.example/keys",
}


@pytest.mark.parametrize(
    "change",
    [
        {"login_url": "http://lms.example/auth"},
        {"token_url": "file:///etc/passwd"},
        {"token_url": "https://lms.example@evil.example/token"},
        {"keys_url": None},
        {"deployments": []},
        {"unknown": 1},
    ],
)
def test_a_wrong_file_is_named_before_the_service_starts(tmp_path, change):
    """An address without TLS, of another kind or with a disguise, a field too few or too many."""
    (tmp_path / "p.json").write_text(json.dumps({"platforms": [ENTRY | change]}))
    with pytest.raises(SettingsError, match=r"p\.json"):
        create_app(Settings(tmp_path, lti=str(tmp_path / "p.json")))


def test_scores_go_to_the_registered_gradebook_only():
    """By default to the origin of the token's address, else to the beginnings that are listed."""
    plain = Platform(**ENTRY)
    listed = Platform(**ENTRY, scores=("https://school.example/api/lti/",))
    assert plain.may_score_at("https://lms.example/items/1") and listed.may_score_at("https://school.example/api/lti/1")
    for wrong in ("https://lms.example:8443/i", "http://lms.example/i", "https://lms.example.evil.example/i", "x", ""):
        assert not plain.may_score_at(wrong)
    for wrong in ("https://lms.example/items/1", "https://school.example/x", "https://school.example/api/lti/../x"):
        assert not listed.may_score_at(wrong)
    assert scores_of("https://a.example/items/1?type=2") == "https://a.example/items/1/scores?type=2"
