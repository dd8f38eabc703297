# A registry is a .def file of lines KIND(name). The C++ table includes it, and this reads the same file, so the
# list of sources and the table cannot disagree; a line without its file stops the configure step.
function(ripplenotch_add_registry target def_file kind source_dir)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${def_file})
    file(STRINGS ${def_file} lines REGEX "^${kind}\\(")
    foreach(line IN LISTS lines)
        string(REGEX REPLACE "^${kind}\\(([a-z0-9_]+)\\).*" "\\1" name "${line}")
        set(source ${source_dir}/${name}.cpp)
        if(NOT EXISTS ${source})
            message(FATAL_ERROR "${def_file} lists ${kind}(${name}), but ${source} does not exist")
        endif()
        target_sources(${target} PRIVATE ${source})
    endforeach()
endfunction()
