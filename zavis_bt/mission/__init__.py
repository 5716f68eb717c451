"""A mission from files: robot, tree, models, recording, and its result."""

from zavis_bt.mission.clock import WallClock
from zavis_bt.mission.device_robot import DeviceRobot
from zavis_bt.mission.dialogue import Dialogue
from zavis_bt.mission.human import Nobody, TerminalHuman, TimeStandsStill, WithTimeout
from zavis_bt.mission.jobs import DoneJob, InlineJobs, ThreadJobs
from zavis_bt.mission.journal import MissionJournal
from zavis_bt.mission.mission import Mission
from zavis_bt.mission.parts import Parts, Task
from zavis_bt.mission.robot_file import RobotFile, load_robot
from zavis_bt.mission.safety import SafeBase, SafePanTilt, SafeRobot, SafetySettings
from zavis_bt.mission.settings import MissionSettings, Search
from zavis_bt.mission.spl import spl

__all__ = [
    "DeviceRobot",
    "Dialogue",
    "DoneJob",
    "InlineJobs",
    "Mission",
    "MissionJournal",
    "MissionSettings",
    "Nobody",
    "Parts",
    "RobotFile",
    "SafeBase",
    "SafePanTilt",
    "SafeRobot",
    "SafetySettings",
    "Search",
    "Task",
    "TerminalHuman",
    "ThreadJobs",
    "TimeStandsStill",
    "WallClock",
    "WithTimeout",
    "load_robot",
    "spl",
]
