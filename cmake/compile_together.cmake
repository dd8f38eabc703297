# Small files of one folder include the same headers and make the same templates again, each by itself. What lies in
# unnamed namespaces meets where they are compiled together, so files that use one name for two things, kernels and entries
# of registries stay alone. Off, a small change is compiled sooner, and a file shows what it forgot to include.
option(RIPPLENOTCH_COMPILE_TOGETHER "Compile files of a folder together" ON)
set(RIPPLENOTCH_FILES_TOGETHER 24)

# ripplenotch_compile_together(target file...): files of one folder, of which those named in ALONE are left out.
function(ripplenotch_compile_together target)
    cmake_parse_arguments(PARSE_ARGV 1 asked "" "" "ALONE")
    set_target_properties(${target} PROPERTIES UNITY_BUILD ${RIPPLENOTCH_COMPILE_TOGETHER} UNITY_BUILD_MODE GROUP)
    set(count 0)
    foreach(file IN LISTS asked_UNPARSED_ARGUMENTS)
        get_filename_component(folder ${file} DIRECTORY)
        get_filename_component(name ${file} NAME_WE)
        if(name IN_LIST asked_ALONE)
            continue()
        endif()
        math(EXPR group "${count} / ${RIPPLENOTCH_FILES_TOGETHER}")
        math(EXPR count "${count} + 1")
        string(MAKE_C_IDENTIFIER "${folder}" folder)
        set_source_files_properties(${file} PROPERTIES UNITY_GROUP ${folder}_${group})
    endforeach()
endfunction()
