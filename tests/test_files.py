"""Files appear complete or not at all."""

import multiprocessing
import os
import stat
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from cylcontact import InputError
from cylcontact.files import replacing, replacing_all, require_writable
from tests.spec_files import assert_told, tree

AS_ROOT = hasattr(os, "geteuid") and os.geteuid() == 0
NOBODY = 65534
REMEDY = "choose a file in a folder you may write to"


def write(path, text="new"):
    with replacing(path) as temporary:
        temporary.write_text(text)


@pytest.mark.parametrize("name", ["out.json", "one/two/out.json"])
def test_a_file_is_written_with_its_folders(tmp_path, name):
    write(tmp_path / name)
    assert (tmp_path / name).read_text() == "new"
    assert [path.name for path in (tmp_path / name).parent.iterdir()] == ["out.json"]


def test_an_old_file_is_replaced_only_at_the_end(tmp_path):
    path = tmp_path / "out.json"
    path.write_text("old")
    with replacing(path) as temporary:
        temporary.write_text("new")
        assert path.read_text() == "old"
    assert tree(tmp_path) == {"out.json": b"new"}


def test_a_plain_string_will_do(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write("out.json")
    assert tree(tmp_path) == {"out.json": b"new"}


def test_the_temporary_file_stands_beside_and_keeps_the_suffix(tmp_path):
    with replacing(tmp_path / "out.parquet") as temporary:
        assert (temporary.parent, temporary.suffix) == (tmp_path, ".parquet")


@pytest.mark.skipif(os.name == "nt", reason="Windows has no umask")
@pytest.mark.parametrize("mask", [0o022, 0o077])
def test_permissions_are_those_of_any_new_file(tmp_path, mask):
    before = os.umask(mask)
    try:
        write(tmp_path / "out.json")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "out.json").stat().st_mode) == 0o666 & ~mask


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such modes")
@pytest.mark.parametrize("mode", [0o600, 0o640, 0o444, 0o666])
def test_a_replaced_file_keeps_its_permissions(tmp_path, mode):
    path = tmp_path / "out.json"
    path.write_text("old")
    path.chmod(mode)
    with replacing(path) as temporary:
        assert stat.S_IMODE(temporary.stat().st_mode) & ~0o200 & ~mode == 0  # nor before
        temporary.write_text("new")
    assert (path.read_text(), stat.S_IMODE(path.stat().st_mode)) == ("new", mode)


@pytest.mark.skipif(not AS_ROOT, reason="only root may give files away")
def test_a_replaced_file_keeps_its_owner(tmp_path):
    path = tmp_path / "out.json"
    path.write_text("old")
    os.chown(path, NOBODY, NOBODY)
    write(path)
    assert (path.stat().st_uid, path.stat().st_gid) == (NOBODY, NOBODY)


def test_a_signal_as_the_temporary_file_is_made_leaves_none(tmp_path, monkeypatch):
    create = os.open

    def interrupted(path, flags, *mode):
        os.close(create(path, flags, *mode))
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "open", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write(tmp_path / "new/out.json")
    monkeypatch.undo()
    assert tree(tmp_path) == {}


def test_files_that_belong_together_are_replaced_together(tmp_path):
    paths = [tmp_path / "out.csv", tmp_path / "new/out.png"]
    paths[0].write_text("old")

    def fail():
        with replacing_all(paths) as temporaries:
            for temporary in temporaries:
                temporary.write_text("new")
            temporaries[1].unlink()  # which fails once the first is complete

    with pytest.raises(InputError):
        fail()
    assert tree(tmp_path) == {"out.csv": b"old"}


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, SystemExit, MemoryError])
@pytest.mark.parametrize("name", ["out.json", "one/two/out.json"])
def test_a_failure_leaves_nothing_not_even_a_folder(tmp_path, error, name):
    def fail():
        with replacing(tmp_path / name) as temporary:
            temporary.write_text("half")
            raise error

    with pytest.raises(error):
        fail()
    assert tree(tmp_path) == {}


def test_a_failure_leaves_the_old_file(tmp_path):
    path = tmp_path / "out.json"
    path.write_text("old")

    def fail():
        with replacing(path) as temporary:
            temporary.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fail()
    assert tree(tmp_path) == {"out.json": b"old"}


def test_a_failure_leaves_folders_that_others_use_meanwhile(tmp_path):
    def fail():
        with replacing(tmp_path / "one/two/out.json"):
            (tmp_path / "one/theirs").write_text("x")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fail()
    assert tree(tmp_path) == {"one": None, "one/theirs": b"x"}


def test_running_out_of_room_is_told_in_one_line(tmp_path):
    path = tmp_path / "out.json"

    def fill():
        with replacing(path):
            raise OSError(28, "No space left on device")

    with pytest.raises(InputError) as caught:
        fill()
    rule = "cannot be written (No space left on device)"
    assert_told(caught, path, "", None, rule, f"{REMEDY}, with room left")
    assert tree(tmp_path) == {}


# --- what cannot be written -------------------------------------------------------------------


def obstacles(root):
    """Return paths that cannot be written, and why."""
    (root / "folder").mkdir()
    (root / "file").write_text("x")
    return [
        (root / "folder", "it is a folder"),
        (Path("/"), "it is a folder"),
        (Path(), "it is a folder"),
        (root / "file/out.json", f"{root / 'file'} is not a folder"),
        (root / "file/one/two/out.json", f"{root / 'file'} is not a folder"),
        (root / f"{'x' * 300}.json", "File name too long"),
        (root / "x\udcff.json", "its name is not text"),
        (root / f"{'x' * 245}.json", "File name too long"),
        (root / "none/../out.json", "it leads through a folder that does not exist"),
    ]


@pytest.mark.parametrize("index", range(9))
@pytest.mark.parametrize("attempt", [write, require_writable])
def test_what_cannot_be_written_is_said_before_anything_is(tmp_path, attempt, index):
    path, reason = obstacles(tmp_path)[index]
    before = tree(tmp_path)
    with pytest.raises(InputError) as caught:
        attempt(path)
    assert_told(caught, path, "", None, f"cannot be written ({reason})", REMEDY)
    assert tree(tmp_path) == before


@pytest.mark.parametrize("attempt", [write, require_writable])
@pytest.mark.parametrize("name", ["out.json", "one/two/out.json"])
def test_permission_is_asked_for_before_anything_is_written(tmp_path, attempt, name, monkeypatch):
    """Also as root, whom no folder's mode stops."""
    monkeypatch.setattr(os, "access", lambda path, _: Path(path) != tmp_path)
    with pytest.raises(InputError) as caught:
        attempt(tmp_path / name)
    rule = f"cannot be written (no permission to write in {tmp_path})"
    assert_told(caught, tmp_path / name, "", None, rule, REMEDY)
    assert tree(tmp_path) == {}


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such modes and users")
@pytest.mark.parametrize("attempt", [write, require_writable])
def test_a_folder_closed_to_writing_is_told(attempt):
    """Root may write into any folder, so for root a user without rights asks."""
    with TemporaryDirectory() as folder:
        Path(folder).chmod(0o555)
        asked = multiprocessing.get_context("fork").Process(target=_refused, args=(folder, attempt))
        asked.start()
        asked.join()
        assert asked.exitcode == 0


def _refused(folder, attempt):
    if AS_ROOT:
        os.setuid(NOBODY)
    with pytest.raises(InputError, match=rf"no permission to write in {folder}"):
        attempt(f"{folder}/out.json")


@pytest.mark.parametrize("name", ["out.json", "one/two/out.json"])
def test_asking_whether_a_file_can_be_written_leaves_no_trace(tmp_path, name):
    require_writable(tmp_path / name)
    assert tree(tmp_path) == {}
