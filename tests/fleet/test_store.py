"""What a fleet reads beside its recordings: storages of a short list, and results that are as they were put."""

import json

import pytest

from bench.errors import InputError
from bench.fleet.evaluate import marked
from bench.fleet.store import Store

KEY = "ab" * 32
INERTIA = {"value": 1e-3, "unit": "kg*m**2", "std_error": 1e-6, "ci95": [9.98e-4, 1.002e-3]}
RESULT = {
    "status": "done",
    "reason": None,
    "parameters": {"moment_of_inertia": INERTIA},
    "checks": [],
    "explained": 0.9,
}


@pytest.mark.parametrize(
    "url",
    ["zip://a.csv::file:///x.zip", "reference://x", "dir:///etc", "simplecache::https://x/a.csv", "://", "x\ty://z"],
)
def test_a_storage_that_nobody_allowed_is_refused_before_anything_is_opened(url):
    with pytest.raises(InputError, match=r"found the storage .* allowed: https, .* --storage allows another"):
        marked(url)


@pytest.mark.parametrize(
    "change",
    [
        lambda kept: {name: value for name, value in kept.items() if name != "status"},
        lambda kept: {**kept, "parameters": {"moment_of_inertia": {**INERTIA, "value": 2e-3}}},
        lambda kept: {**kept, "sha256": None},
        lambda kept: [kept],
        lambda kept: None,
        lambda kept: "done",
        lambda kept: {},
    ],
)
def test_a_result_that_was_tampered_with_is_none(tmp_path, change):
    store = Store(tmp_path)
    store.put(KEY, RESULT)
    kept = json.loads(store.path(KEY).read_text())
    assert {name: value for name, value in (store.get(KEY) or {}).items() if name != "schema"} == RESULT
    store.path(KEY).write_text(json.dumps(change(kept)))
    assert store.get(KEY) is None


@pytest.mark.parametrize(
    "change",
    [
        {"status": "well"},
        {"reason": 3},
        {"parameters": 0.5},
        {"parameters": {"moment_of_inertia": {**INERTIA, "value": "1e-3"}}},
        {"parameters": {"moment_of_inertia": {**INERTIA, "value": 1e308}}},
        {"parameters": {"moment_of_inertia": {**INERTIA, "ci95": []}}},
        {"checks": [{}]},
        {"effects": ["cogging_torque"]},
        {"gap": {"torque": None}},
    ],
)
def test_neither_is_one_whose_sum_is_right_and_whose_content_ended_the_fleet(tmp_path, change):
    store = Store(tmp_path)
    store.put(KEY, {**RESULT, **change})
    assert store.get(KEY) is None
    store.put(KEY, {**RESULT, "explained": 1})
    assert type((store.get(KEY) or {})["explained"]) is float
