# Man pages and completions, printed by the program itself from what its --help is printed from. A program for another
# machine that cannot be run here gets none; the configuration says so.
set(RIPPLENOTCH_REFERENCE ${PROJECT_BINARY_DIR}/reference)
set(RIPPLENOTCH_MAN_PAGES ripplenotch.1)
if(CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR)
    message(STATUS "no man pages and completions: the program for ${CMAKE_SYSTEM_PROCESSOR} cannot be run here to print them")
    set(RIPPLENOTCH_MAN_PAGES)
    return()
endif()
set(reference_files)

function(ripplenotch_reference_file kind file)
    add_custom_command(OUTPUT ${RIPPLENOTCH_REFERENCE}/${file} DEPENDS ripplenotch_cli
        COMMAND ${CMAKE_COMMAND} -E make_directory ${RIPPLENOTCH_REFERENCE}
        COMMAND ripplenotch_cli --generate ${kind} > ${RIPPLENOTCH_REFERENCE}/${file} VERBATIM)
    set(reference_files ${reference_files} ${RIPPLENOTCH_REFERENCE}/${file} PARENT_SCOPE)
endfunction()

ripplenotch_reference_file(man ripplenotch.1)
file(STRINGS ${PROJECT_SOURCE_DIR}/src/cli/commands.def lines REGEX "^COMMAND")
foreach(line IN LISTS lines)
    string(REGEX REPLACE "^COMMAND\\(([a-z]+)_?\\).*" "\\1" command "${line}")
    ripplenotch_reference_file(man-${command} ripplenotch-${command}.1)
    list(APPEND RIPPLENOTCH_MAN_PAGES ripplenotch-${command}.1)
endforeach()
ripplenotch_reference_file(complete-bash ripplenotch.bash)
# When it is installed: an edit of the program prints none of them.
add_custom_target(ripplenotch_reference DEPENDS ${reference_files})
