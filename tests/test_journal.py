"""An interrupted campaign resumes to the result of an uninterrupted one."""

import json

import pytest

from cylcontact import InputError
from cylcontact.fitting import calibrate
from cylcontact.journal import Journal
from tests.spec_files import DROP, assert_told, changed, tree

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


def test_every_run_is_kept_as_it_is_in_the_result(complete, small_result):
    kept = [json.loads(line) for line in complete[1:]]
    runs = small_result.repeatable()["runs"]
    assert [{k: v for k, v in run.items() if k != "seconds"} for run in kept] == runs


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


def test_nothing_is_written_before_a_run_is_complete(path, tmp_path, small_campaign):
    def interrupt(stage, _, __):
        if stage == "searching":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        calibrate(small_campaign, progress=interrupt, checkpoint=path)
    assert tree(tmp_path) == {}


# --- what cannot be resumed -------------------------------------------------------------------


@pytest.mark.parametrize(
    "contents",
    ['{"format": 1, "campaign": "0123"}\n', "[axes.E]\nmin = 69\n", "\n", "\x89PNG\n\0", "{}"],
)
def test_a_journal_of_another_campaign_is_refused_and_left_alone(path, small_campaign, contents):
    path.parent.mkdir()
    path.write_text(contents)
    with pytest.raises(InputError) as caught:
        resume(small_campaign, path)
    assert_told(caught, path, "", None, "its campaign or settings differ", f"{ANEW} to start")
    assert path.read_text() == contents


@pytest.mark.parametrize("version", [None, 0, 2, "1"])
def test_a_journal_of_another_version_is_refused_and_left_alone(
    complete, path, small_campaign, version
):
    header = json.loads(complete[0]) | {"format": version}
    if version is None:
        del header["format"]
    path.write_text(json.dumps(header) + "\n" + "".join(complete[1:]))
    before = path.read_bytes()
    with pytest.raises(InputError) as caught:
        resume(small_campaign, path)
    rule = "is that of another version of cylcontact, not 1"
    remedy = "finish the work with that version, or run without --resume to start anew"
    assert_told(caught, path, "format", version, rule, remedy)
    assert path.read_bytes() == before


@pytest.mark.parametrize("line", ["{not json}", "", '{"index": 0', "9" * 5000])
def test_a_damaged_line_is_refused(complete, path, small_campaign, line):
    path.write_text(complete[0] + line + "\n" + complete[2])
    with pytest.raises(InputError) as caught:
        resume(small_campaign, path)
    assert_told(caught, path, "", None, "has a damaged line", ANEW)


@pytest.mark.parametrize(
    ("changes", "key", "value", "rule"),
    [
        ({"seed": "1"}, "seed", "1", "must be an integer"),
        ({"objective": DROP}, "objective", None, "is required"),
        ({"objective": None}, "objective", None, "must be a number"),
        ({"coefficients.n": "1"}, "coefficients.n", "1", "must be a number"),
        ({"colour": 1}, "colour", 1, "is not a known key"),
    ],
)
def test_a_line_that_is_no_run_is_refused(
    complete, path, small_campaign, changes, key, value, rule
):
    path.write_text(complete[0] + json.dumps(changed(json.loads(complete[1]), changes)) + "\n")
    with pytest.raises(InputError) as caught:
        resume(small_campaign, path)
    assert_told(caught, path, key, value, rule, caught.value.remedy)


@pytest.mark.parametrize("line", ["3", "[]", "null"])
def test_a_line_that_is_no_table_is_refused(complete, path, small_campaign, line):
    path.write_text(complete[0] + line + "\n")
    with pytest.raises(InputError) as caught:
        resume(small_campaign, path)
    assert_told(caught, path, "", json.loads(line), "must be a table", caught.value.remedy)


def test_a_folder_in_its_place_is_an_input_error(path, small_campaign):
    path.mkdir(parents=True)
    for resumed in (True, False):
        with pytest.raises(InputError) as caught:
            calibrate(small_campaign, checkpoint=path, resume=resumed)
        assert_told(caught, path, "", None, "cannot be used (it is a folder)", "move it away")


def test_a_journal_that_cannot_be_written_is_an_input_error(tmp_path):
    (tmp_path / "file").write_text("x")
    path = tmp_path / "file/small.json.partial"
    with pytest.raises(InputError) as caught:
        Journal(path, "campaign", "key").add({"index": 0})
    assert_told(caught, path, "", None, "cannot be written (", "the parts already in it are kept")
