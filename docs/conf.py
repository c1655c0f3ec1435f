"""How Sphinx builds the site: `make docs`. What is ours in it lives in `_extensions`; pages are in `guide` and beside.

Nothing is fetched while building or reading: no inventories of other projects, no fonts, no scripts from elsewhere.
"""

import logging
import sys
from pathlib import Path

import octomarch

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_extensions"))

project = "octomarch"
author = "octomarch developers"
project_copyright = author
version = release = octomarch.__version__

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "myst_nb",  # Markdown by MyST, and notebooks
    "sphinx_gallery.gen_gallery",
    "sphinx_codeautolink",
    "examples",
    "gallery_pictures",
    "project_links",
    "reference_pages",
]
exclude_patterns = ["_extensions", "gallery/**.py", "gallery/**.ipynb", "sg_execution_times.rst"]
nitpicky = True
# Types of other projects, and words of docstrings that are no names.
nitpick_ignore_regex = [
    (r"py:.*", r"(numpy\.|collections\.|typing\.|os\.|NDArray|ndarray|dtype|np\.).*"),
    (
        r"py:.*",
        r"(TypeError|ValueError|AttributeError|OSError|KeyboardInterrupt|RuntimeError|ImportError|FileNotFoundError)",
    ),
    (r"py:obj", r"[a-z_]+"),  # parameters whose names are those of modules too
    (r"py:.*", r"(Enum|IntEnum|enum\.IntEnum|int|object|Field|octomarch\.queries\.Field)"),
]
highlight_language = "python"
default_role = "autolink"

autodoc_member_order = "bysource"
autodoc_typehints = "none"
autosummary_generate = False
numpydoc_show_class_members = False
toc_object_entries_show_parents = "hide"

myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 3

# Notebooks are kept without results, and run whenever their page is made.
nb_execution_mode = "force"
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 600
nb_merge_streams = True
logging.getLogger("traitlets").setLevel(logging.WARNING)  # it tells of each notebook that it runs

# Blocks of a page go on where the last one ended.
codeautolink_concat_default = True
codeautolink_global_preface = "import numpy as np; import octomarch as om"
codeautolink_autodoc_inject = False
suppress_warnings = ["codeautolink"]  # it tells of blocks whose links are there already, from the last build

sphinx_gallery_conf = {
    "examples_dirs": "../examples/gallery",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",
    "ignore_pattern": r"(^|/)_",  # scenes that several pictures share
    "within_subsection_order": "FileNameSortKey",
    "image_scrapers": ("gallery_pictures.saved_picture",),
    "reset_modules": (),
    "reset_argv": "gallery_pictures.output_argument",
    "run_stale_examples": True,  # a picture depends on octomarch too, not only on its script
    "abort_on_example_error": False,
    "only_warn_on_example_error": True,
    "download_all_examples": False,
    "show_signature": False,
    "show_memory": False,
    "write_computation_times": False,
    "min_reported_time": 1e9,
    "thumbnail_size": (320, 240),
    "remove_config_comments": True,
}

html_theme = "furo"
html_title = "octomarch"
html_static_path = ["_static"]
html_css_files = ["octomarch.css"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"navigation_with_keys": True}
