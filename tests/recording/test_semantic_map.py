import pytest
from scripted_mission import LANDMARKS

from zavis_bt.errors import InputError
from zavis_bt.recording import landmarks_to_json, load_landmarks


def test_landmarks_come_back_as_they_were(tmp_path):
    path = tmp_path / "semantic_map.json"
    path.write_text(landmarks_to_json(LANDMARKS))
    assert load_landmarks(path) == LANDMARKS


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("[", "not JSON"),
        ('{"format": "zavis-semantic-map/1", "landmarks": [{"id": "x"}]}', "landmarks.0.id: "),
        ('{"format": "zavis-semantic-map/2", "landmarks": []}', "format is .*'zavis-semantic-map/1' would be right"),
    ],
)
def test_what_is_no_semantic_map_is_said_so(tmp_path, content, message):
    path = tmp_path / "semantic_map.json"
    path.write_text(content)
    with pytest.raises(InputError, match=message):
        load_landmarks(path)


def test_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"none\.json: cannot be read: No such file"):
        load_landmarks(tmp_path / "none.json")
