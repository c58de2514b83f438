"""An interrupted campaign resumes to the result of an uninterrupted one."""

import json

import pytest

from cylcontact import InputError
from cylcontact.fitting import calibrate
from cylcontact.journal import Journal
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


@pytest.mark.parametrize("runs", [0, 1, 2, 3])
def test_a_resumed_campaign_gives_the_uninterrupted_result(
    complete, path, small_campaign, small_result, runs
):
    path.write_text("".join(complete[: 1 + runs]))
    result = resume(small_campaign, path)
    assert result.repeatable() == small_result.repeatable()
    assert path.read_text().splitlines(keepends=True)[: 1 + runs] == complete[: 1 + runs]
    assert len(path.read_text().splitlines()) == 4


def test_kept_runs_are_not_run_again(complete, path, small_campaign):
    path.write_text("".join(complete[:3]))
    seen = []
    calibrate(
        small_campaign,
        progress=lambda stage, done, _: seen.append(done) if stage == "searching" else None,
        checkpoint=path,
        resume=True,
    )
    assert seen == [2, 3]


def test_runs_that_ended_out_of_order_resume_to_the_same_result(
    complete, path, small_campaign, small_result
):
    path.write_text(complete[0] + complete[3] + complete[1])
    assert resume(small_campaign, path, jobs=2).repeatable() == small_result.repeatable()


@pytest.mark.parametrize("cut", [1, 20, -1])
def test_a_line_cut_short_is_dropped_and_its_run_redone(
    complete, path, small_campaign, small_result, cut
):
    path.write_text("".join(complete[:2]) + complete[2][:cut])
    assert resume(small_campaign, path).repeatable() == small_result.repeatable()
    kept = [json.loads(line) for line in path.read_text().splitlines()[1:]]
    assert [run["index"] for run in kept] == [0, 1, 2]


@pytest.mark.parametrize("cut", [0, 1, 20, -1])
def test_a_file_cut_short_in_its_header_holds_no_runs(
    complete, path, small_campaign, small_result, cut
):
    path.write_text(complete[0][:cut])
    assert resume(small_campaign, path).repeatable() == small_result.repeatable()
    assert path.read_text().splitlines(keepends=True)[0] == complete[0]


def test_resuming_without_a_file_starts_one(path, small_campaign, small_result):
    assert resume(small_campaign, path).repeatable() == small_result.repeatable()
    assert len(path.read_text().splitlines()) == 4


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


def test_a_folder_in_its_place_is_refused(path, small_campaign):
    path.mkdir(parents=True)
    with pytest.raises(InputError) as caught:
        calibrate(small_campaign, checkpoint=path)
    assert_told(caught, path, "", None, "cannot be written (it is a folder)", "may write to")
