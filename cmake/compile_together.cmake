# Small files of one room include the same headers and make the same templates again, each by itself. What lies in
# unnamed namespaces meets where they are compiled together, so kernels and entries of registries, which use one name for
# what each of them has, stay alone. Off, a small change is compiled sooner, and a file shows what it forgot to include.
option(RIPPLENOTCH_COMPILE_TOGETHER "Compile files of a room together" ON)
set(RIPPLENOTCH_FILES_TOGETHER 72)

# ripplenotch_compile_together(target room file...): files of a room, neighbours in the list with each other.
function(ripplenotch_compile_together target room)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ${RIPPLENOTCH_COMPILE_TOGETHER} UNITY_BUILD_MODE GROUP)
    # Parts of one size: the last would be as dear as the first, for a few files.
    list(LENGTH ARGN files)
    math(EXPR parts "(${files} + ${RIPPLENOTCH_FILES_TOGETHER} - 1) / ${RIPPLENOTCH_FILES_TOGETHER}")
    set(count 0)
    foreach(file IN LISTS ARGN)
        math(EXPR part "${count} * ${parts} / ${files}")
        math(EXPR count "${count} + 1")
        set_source_files_properties(${file} PROPERTIES UNITY_GROUP ${room}_${part})
    endforeach()
endfunction()
