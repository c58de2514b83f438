"""An interrupted campaign resumes to the result of an uninterrupted one."""

import json

import pytest

from cylcontact import InputError
from cylcontact.files.journal import Journal
from cylcontact.fitting import calibrate
from tests.support.spec_files import assert_told

ANEW = "run without --resume"


@pytest.fixture
def path(tmp_path):
    return tmp_path / "results/small.json.partial"


@pytest.fixture(scope="module")
def lines(small_campaign, tmp_path_factory):
    """The lines of a journal of all runs: a header, then one for each run."""
    path = tmp_path_factory.mktemp("journal") / "small.json.partial"
    calibrate(small_campaign, checkpoint=path)
    return path.read_text(encoding="utf-8").splitlines(keepends=True)


@pytest.fixture
def complete(lines, path):
    """The same lines, in their file."""
    path.parent.mkdir()
    path.write_text("".join(lines))
    return lines


def resume(campaign, path, jobs=1):
    return calibrate(campaign, jobs, checkpoint=path, resume=True)


# --- resuming ---------------------------------------------------------------------------------

# What is kept of the header and the three runs, and how many runs that is.
KEPT = {
    "nothing": ("", 0),
    "a header cut short": ("{0:.20}", 0),
    "a header": ("{0}", 0),
    "two runs": ("{0}{1}{2}", 2),
    "out of order": ("{0}{3}{1}", 2),
    "a line cut short": ("{0}{1}{2:.20}", 1),
    "all": ("{0}{1}{2}{3}", 3),
}


@pytest.mark.parametrize("what", KEPT)
def test_a_resumed_campaign_gives_the_uninterrupted_result(
    complete, path, small_campaign, small_result, what
):
    text, runs = KEPT[what]
    path.write_text(text.format(*complete))
    seen = []
    result = calibrate(
        small_campaign,
        progress=lambda stage, done, _: seen.append(done) if stage == "searching" else None,
        checkpoint=path,
        resume=True,
    )
    assert seen[0] == runs
    assert result.repeatable() == small_result.repeatable()
    lines = path.read_text().splitlines(keepends=True)
    assert lines[0] == complete[0]
    assert sorted(json.loads(line)["index"] for line in lines[1:]) == [0, 1, 2]


def test_without_resume_the_kept_runs_are_replaced(complete, path, small_campaign, small_result):
    path.write_text("something else altogether")
    result = calibrate(small_campaign, checkpoint=path)
    assert result.repeatable() == small_result.repeatable()
    assert [json.loads(line).get("index") for line in path.read_text().splitlines()] == [
        *(None, 0, 1, 2)
    ]
    assert path.read_text().startswith(complete[0])


def test_interrupted_by_the_user_after_a_run(path, small_campaign, small_result):
    def interrupt(stage, done, _):
        if (stage, done) == ("searching", 1):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        calibrate(small_campaign, progress=interrupt, checkpoint=path)
    assert len(path.read_text().splitlines()) == 2
    assert resume(small_campaign, path).repeatable() == small_result.repeatable()


@pytest.mark.parametrize("contents", ["", "3", '{"campaign": "0"}', '{"format": 2}'])
def test_a_journal_of_other_work_is_refused_and_left_alone(path, small_campaign, contents):
    path.parent.mkdir()
    path.write_text(f"{contents}\n")
    with pytest.raises(InputError) as caught:
        resume(small_campaign, path)
    rule = "belongs to other work: its campaign or settings differ"
    assert_told(caught, path, "", None, rule, ANEW)
    assert path.read_text() == f"{contents}\n"


@pytest.mark.parametrize("line", ["{", "null", "3"])
def test_a_damaged_line_is_refused(complete, path, line):
    path.write_text(f"{complete[0]}{line}\n")
    with pytest.raises(InputError) as caught:
        Journal(path, *list(json.loads(complete[0]).items())[1]).load(dict)
    assert_told(caught, path, "", None, "has a damaged line", ANEW)
