# Libraries that are not ours: octomarch_xsimd, octomarch_glm (header only, as system headers), octomarch_doctest (with
# the tests) and pybind11. What is installed comes first; a release archive with a known hash is the last resort.
include(FetchContent)
include(Xsimd)

# Downloads an archive of headers without running its own CMake files. Sets <name>_SOURCE_DIR in the caller.
macro(octomarch_fetch_headers name hint url sha256)
  message(STATUS "${name} not found (${hint}): downloading ${url}")
  FetchContent_Declare(${name} URL "${url}" URL_HASH SHA256=${sha256} SOURCE_SUBDIR headers-only)
  FetchContent_MakeAvailable(${name})
endmacro()

# GLM ≥ 0.9.9.8. Its newer releases set no version in their package, so it is read from the header.
function(octomarch_find_glm)
  find_package(glm CONFIG QUIET)
  if(TARGET glm::glm)
    get_target_property(include_dirs glm::glm INTERFACE_INCLUDE_DIRECTORIES)
    list(GET include_dirs 0 include_dir)
  else()
    octomarch_fetch_headers(glm "Debian: libglm-dev" https://github.com/g-truc/glm/archive/refs/tags/1.0.1.tar.gz
                            9f3174561fd26904b23f0db5e560971cbf9b3cbda0b280f04d5c379d03bf234c)
    set(include_dir "${glm_SOURCE_DIR}")
  endif()
  octomarch_version_from_header(version "${include_dir}/glm/detail/setup.hpp" GLM_VERSION MAJOR MINOR PATCH REVISION)
  if(version VERSION_LESS 0.9.9.8)
    message(FATAL_ERROR "GLM ${version} in ${include_dir} is too old: octomarch needs 0.9.9.8 or newer")
  endif()
  message(STATUS "GLM ${version} in ${include_dir}")
  add_library(octomarch_glm INTERFACE)
  target_include_directories(octomarch_glm SYSTEM INTERFACE "${include_dir}")
  set(OCTOMARCH_GLM_VERSION "${version}" PARENT_SCOPE)
endfunction()

function(octomarch_find_doctest)
  find_package(doctest CONFIG QUIET)
  if(TARGET doctest::doctest)
    get_target_property(include_dirs doctest::doctest INTERFACE_INCLUDE_DIRECTORIES)
    list(GET include_dirs 0 include_dir)
  else()
    octomarch_fetch_headers(doctest "Debian: doctest-dev"
                            https://github.com/doctest/doctest/archive/refs/tags/v2.4.11.tar.gz
                            632ed2c05a7f53fa961381497bf8069093f0d6628c5f26286161fbd32a560186)
    set(include_dir "${doctest_SOURCE_DIR}")
  endif()
  add_library(octomarch_doctest INTERFACE)
  target_include_directories(octomarch_doctest SYSTEM INTERFACE "${include_dir}")
endfunction()

# pybind11 of the build's interpreter, unless CMake already knows one (scikit-build-core tells it).
function(octomarch_find_pybind11)
  execute_process(COMMAND "${Python_EXECUTABLE}" -m pybind11 --cmakedir
                  OUTPUT_VARIABLE cmake_dir OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  find_package(pybind11 3.1 CONFIG REQUIRED GLOBAL HINTS "${cmake_dir}")
endfunction()

octomarch_find_xsimd()
octomarch_find_glm()
octomarch_find_pybind11()
