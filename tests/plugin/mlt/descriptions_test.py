# SPDX-License-Identifier: Apache-2.0
"""What editors are told of the plugin says what the plugin itself says."""
import ctypes
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

PLUGIN = pathlib.Path(os.environ["RSSTAB_FREI0R_PLUGIN"])
DESCRIPTIONS = pathlib.Path(__file__).resolve().parents[3] / "plugin" / "mlt"
DOUBLE, TEXT = 1, 4  # F0R_PARAM_DOUBLE, F0R_PARAM_STRING


class ParamInfo(ctypes.Structure):
    _fields_ = [("name", ctypes.c_char_p), ("type", ctypes.c_int), ("text", ctypes.c_char_p)]


class PluginInfo(ctypes.Structure):
    _fields_ = [("name", ctypes.c_char_p), ("author", ctypes.c_char_p)] + [
        (field, ctypes.c_int) for field in ("type", "color", "frei0r", "major", "minor", "count")
    ] + [("text", ctypes.c_char_p)]


def read_plugin():
    """Name of the plugin, and name, type and default of each parameter."""
    library = ctypes.CDLL(str(PLUGIN))
    library.f0r_construct.restype = ctypes.c_void_p
    for function in (library.f0r_get_param_value, library.f0r_destruct):
        function.argtypes = [ctypes.c_void_p] * 2 + [ctypes.c_int]
    library.f0r_destruct.argtypes = [ctypes.c_void_p]
    plugin = PluginInfo()
    library.f0r_get_plugin_info(ctypes.byref(plugin))
    instance = library.f0r_construct(64, 48)
    parameters = []
    for index in range(plugin.count):
        info = ParamInfo()
        library.f0r_get_param_info(ctypes.byref(info), index)
        value = ctypes.c_double() if info.type == DOUBLE else ctypes.c_char_p()
        library.f0r_get_param_value(instance, ctypes.addressof(value), index)
        default = value.value if info.type == DOUBLE else value.value.decode()
        parameters.append((info.name.decode(), info.type, default))
    library.f0r_destruct(instance)
    return plugin.name.decode(), parameters


class Kdenlive(unittest.TestCase):
    def test_effect_matches_the_plugin(self):
        name, parameters = read_plugin()
        effect = ElementTree.parse(DESCRIPTIONS / "frei0r_rsstabilize.xml").getroot()
        self.assertEqual(effect.get("tag"), "frei0r." + PLUGIN.stem)
        self.assertEqual(effect.get("id"), effect.get("tag"))
        self.assertEqual(effect.findtext("name"), name)
        shown = effect.findall("parameter")
        self.assertEqual(len(shown), len(parameters))
        for index, (parameter, (title, kind, default)) in enumerate(zip(shown, parameters)):
            with self.subTest(title):
                self.assertEqual(parameter.get("name"), str(index))
                self.assertEqual(parameter.findtext("name"), title)
                if kind == TEXT:
                    self.assertIn(parameter.get("type"), ("url", "list"))
                    self.assertEqual(parameter.get("default"), default)
                else:
                    self.assertEqual(parameter.get("type"), "constant")
                    factor = float(parameter.get("factor"))
                    self.assertAlmostEqual(float(parameter.get("default")) / factor, default)
                    self.assertAlmostEqual(float(parameter.get("max")) / factor, 1.0)
                    self.assertGreaterEqual(float(parameter.get("min")), 0.0)

    def test_choices_are_those_of_the_interface(self):
        effect = ElementTree.parse(DESCRIPTIONS / "frei0r_rsstabilize.xml").getroot()
        choice = next(p for p in effect.findall("parameter") if p.get("type") == "list")
        values = choice.get("paramlist").split(";")
        self.assertEqual(len(values), len(choice.findtext("paramlistdisplay").split(",")))
        self.assertIn(choice.get("default"), values)


@unittest.skipUnless(shutil.which("melt"), "melt is not installed")
class Mlt(unittest.TestCase):
    def query(self, *extra):
        """What melt knows of the plugin, with files laid over those of its own data."""
        with tempfile.TemporaryDirectory() as folder:
            data = pathlib.Path(folder) / "data"
            installed = next(pathlib.Path("/usr/share").glob("mlt-7*"), None)
            if installed is None:
                self.skipTest("MLT's data folder is not in /usr/share")
            shutil.copytree(installed, data)
            for file in extra:
                shutil.copy(file, data / "frei0r")
            environment = dict(os.environ, MLT_DATA=str(data), FREI0R_PATH=str(PLUGIN.parent))
            run = subprocess.run(
                ["melt", "-query", "filter=frei0r." + PLUGIN.stem],
                env=environment, capture_output=True, text=True, timeout=120, check=True)
        return run.stdout

    def parameters(self, answer):
        blocks = answer.split("parameters:")[1].split("- identifier: ")[1:]
        return [{key: text.strip() for key, text in re.findall(r"^ *(\w+): (.*)$", "identifier: "
                 + block, re.MULTILINE)} for block in blocks]

    def check(self, answer):
        name, parameters = read_plugin()
        self.assertIn("title: " + name, answer)
        found = self.parameters(answer)
        self.assertEqual(len(found), len(parameters))
        for index, (shown, (title, kind, default)) in enumerate(zip(found, parameters)):
            with self.subTest(title):
                self.assertEqual(shown["identifier"], str(index))
                self.assertEqual(shown["title"], title)
                self.assertEqual(shown["type"], "string" if kind == TEXT else "float")
                if kind == DOUBLE:
                    self.assertAlmostEqual(float(shown["default"]), default)

    def test_plugin_describes_itself(self):
        self.check(self.query())

    def test_description_matches_the_plugin(self):
        answer = self.query(DESCRIPTIONS / "filter_frei0r.rsstabilize.yml")
        self.assertIn("license: Apache-2.0", answer)  # the file, not the plugin, answered
        self.check(answer)


if __name__ == "__main__":
    unittest.main()
