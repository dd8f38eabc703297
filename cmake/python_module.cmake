# Whether the Python module is built (src/python), and what that asks of the targets that are linked into it.
set(RIPPLENOTCH_PYTHON_FOUND FALSE)
if(RIPPLENOTCH_PYTHON AND NOT RIPPLENOTCH_ROOMS AND NOT RIPPLENOTCH_SANITIZE)
    # Unless it is named: the first Python that has NumPy. What is on the path may be a script that looks for it (pyenv).
    foreach(candidate IN ITEMS python3 /usr/bin/python3)
        if(NOT Python_EXECUTABLE)
            execute_process(COMMAND ${candidate} -c "import numpy, sys; print(sys.executable)" OUTPUT_VARIABLE executable
                            OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
            set(Python_EXECUTABLE "${executable}" CACHE FILEPATH "The Python that the module is for" FORCE)
        endif()
    endforeach()
    find_package(Python COMPONENTS Interpreter Development.Module)
    set(PYBIND11_FINDPYTHON ON)
    find_package(pybind11 2.10 CONFIG)
    if(pybind11_FOUND AND Python_Development.Module_FOUND)
        set(RIPPLENOTCH_PYTHON_FOUND TRUE)
    elseif(RIPPLENOTCH_PYTHON STREQUAL auto)
        message(STATUS "no Python module: pybind11 or Python's headers are missing (apt-get install pybind11-dev python3-dev)")
    else()
        message(FATAL_ERROR "the Python module needs pybind11 and Python's headers: apt-get install pybind11-dev python3-dev, "
                "name another Python with -DPython_EXECUTABLE=, or leave the module out with -DRIPPLENOTCH_PYTHON=OFF")
    endif()
endif()

# A module is a shared library, so its code may lie anywhere. Nobody replaces its functions from outside: calls within the library
# stay direct and inlined, as they are in the program.
function(ripplenotch_part_of_module target)
    if(RIPPLENOTCH_PYTHON_FOUND)
        set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
        target_compile_options(${target} PRIVATE -fno-semantic-interposition)
    endif()
endfunction()
