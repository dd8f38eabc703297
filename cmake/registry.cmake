# A registry is a .def file of lines KIND(name), which the C++ table includes, beside one file a name. Whatever lies in a
# room is compiled, so the two are held against each other here: a line without its file, and a file without its line,
# stop the configure step.

# "FOLDER/NAME.cpp" with the names in it; a folder has no underscore at its end, which a keyword of C++ needs.
function(ripplenotch_entry_file where name file)
    string(REGEX REPLACE "_$" "" entry_folder ${name})
    string(REPLACE FOLDER ${entry_folder} path ${where})
    string(REPLACE NAME ${name} path ${path})
    set(${file} ${path} PARENT_SCOPE)
endfunction()

function(ripplenotch_compare_registry def_file kind found where)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${def_file})
    get_filename_component(folder ${def_file} DIRECTORY)
    file(STRINGS ${def_file} lines REGEX "^${kind}\\(")
    list(TRANSFORM lines REPLACE "^${kind}\\(([a-z0-9_]+)\\).*" "\\1" OUTPUT_VARIABLE listed)
    foreach(name IN LISTS listed)
        if(NOT name IN_LIST found)
            ripplenotch_entry_file(${where} ${name} file)
            message(FATAL_ERROR "${def_file} lists ${kind}(${name}), but ${folder}/${file} does not exist")
        endif()
    endforeach()
    foreach(name IN LISTS found)
        if(NOT name IN_LIST listed)
            ripplenotch_entry_file(${where} ${name} file)
            message(FATAL_ERROR "${folder}/${file} is no ${kind} of ${def_file}: add the line ${kind}(${name})")
        endif()
    endforeach()
endfunction()

# Every file of the folder is an entry.
function(ripplenotch_check_registry def_file kind)
    get_filename_component(folder ${def_file} DIRECTORY)
    file(GLOB found RELATIVE ${folder} CONFIGURE_DEPENDS ${folder}/*.cpp)
    list(TRANSFORM found REPLACE "[.]cpp$" "")
    ripplenotch_compare_registry(${def_file} ${kind} "${found}" NAME.cpp)
endfunction()

# An entry is a folder, whose file of the same name defines it; other folders are what entries share.
function(ripplenotch_check_registry_of_folders def_file kind definition)
    get_filename_component(folder ${def_file} DIRECTORY)
    file(GLOB files CONFIGURE_DEPENDS ${folder}/*/*.cpp)
    set(found)
    foreach(file IN LISTS files)
        file(STRINGS ${file} defined REGEX "^${definition}")
        get_filename_component(name ${file} NAME_WE)
        if(defined)
            list(APPEND found ${name})
        endif()
    endforeach()
    ripplenotch_compare_registry(${def_file} ${kind} "${found}" FOLDER/NAME.cpp)
endfunction()
