# Tests of the program as users start it, in Python, one ctest entry per file.
find_program(VOLMARK_PYTHON NAMES python3 PATHS /usr/bin NO_DEFAULT_PATH)
if(NOT VOLMARK_PYTHON)
  find_program(VOLMARK_PYTHON NAMES python3 REQUIRED)
endif()

# volmark_pytest(<name> <file or folder>): runs pytest; the program and build folder come by environment.
function(volmark_pytest name path)
  add_test(NAME ${name} COMMAND ${VOLMARK_PYTHON} -m pytest -q -p no:cacheprovider ${path})
  set_tests_properties(${name} PROPERTIES TIMEOUT 600 ENVIRONMENT
    "VOLMARK_PROGRAM=$<TARGET_FILE:volmark_program>;VOLMARK_BUILD=${PROJECT_BINARY_DIR};VOLMARK_SOURCE=${PROJECT_SOURCE_DIR};PYTHONDONTWRITEBYTECODE=1;PYTHONPATH=${PROJECT_SOURCE_DIR}/analysis")
endfunction()

volmark_pytest(program.commands ${CMAKE_CURRENT_LIST_DIR}/test_commands.py)
volmark_pytest(program.bad_input ${CMAKE_CURRENT_LIST_DIR}/test_bad_input.py)
volmark_pytest(program.volumes ${CMAKE_CURRENT_LIST_DIR}/test_volumes.py)
volmark_pytest(program.grid ${CMAKE_CURRENT_LIST_DIR}/test_grid.py)
volmark_pytest(program.builds ${CMAKE_CURRENT_LIST_DIR}/test_builds.py)
volmark_pytest(program.status ${CMAKE_CURRENT_LIST_DIR}/test_status.py)
volmark_pytest(program.isolation ${CMAKE_CURRENT_LIST_DIR}/test_isolation.py)
volmark_pytest(program.faults ${CMAKE_CURRENT_LIST_DIR}/test_faults.py)
volmark_pytest(program.many_machines ${CMAKE_CURRENT_LIST_DIR}/test_many_machines.py)
volmark_pytest(program.real_techniques ${CMAKE_CURRENT_LIST_DIR}/test_real_techniques.py)
volmark_pytest(program.devices ${CMAKE_CURRENT_LIST_DIR}/test_devices.py)
volmark_pytest(program.surfaces ${CMAKE_CURRENT_LIST_DIR}/test_surfaces.py)
volmark_pytest(program.picture_errors ${CMAKE_CURRENT_LIST_DIR}/test_picture_errors.py)
volmark_pytest(program.outside_technique ${CMAKE_CURRENT_LIST_DIR}/test_outside_technique.py)
volmark_pytest(analysis ${PROJECT_SOURCE_DIR}/analysis/tests)
volmark_pytest(scenes ${PROJECT_SOURCE_DIR}/scenes/tests)
