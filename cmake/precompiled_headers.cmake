# Reading the standard library anew in each of 400 files took a third of all compiling. Off, every file has to include
# what it uses (preset `odr`); tests/house/test_headers.py looks that up for the public headers.
option(RIPPLENOTCH_PRECOMPILED_HEADERS "Read the standard headers once for all files of a target" ON)
function(ripplenotch_precompile target)
    if(RIPPLENOTCH_PRECOMPILED_HEADERS)
        target_precompile_headers(${target} PRIVATE ${ARGN})
    endif()
endfunction()
