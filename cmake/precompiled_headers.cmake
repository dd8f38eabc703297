# The standard library is read once for all files of a target. Off, every file has to include what it uses, which it does.
option(RIPPLENOTCH_PRECOMPILED_HEADERS "Read the standard headers once for all files of a target" ON)
function(ripplenotch_precompile target)
    if(RIPPLENOTCH_PRECOMPILED_HEADERS)
        target_precompile_headers(${target} PRIVATE ${ARGN})
    endif()
endfunction()
