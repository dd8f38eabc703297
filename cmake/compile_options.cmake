# Warnings, sanitizers and numerics of our own targets; third-party headers are left alone.
# -ffp-contract=off: the same source gives the same bytes whichever instruction set the compiler targets.
add_library(ripplenotch_options INTERFACE)
target_compile_options(ripplenotch_options INTERFACE
    -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wnon-virtual-dtor -ffp-contract=off)
# g++ 12 and 14 see overlapping and overlong copies inside std::string (its bugs 105651 and 105329) where more is inlined.
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    target_compile_options(ripplenotch_options INTERFACE -Wno-restrict -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
endif()
# What a file of this size leaves in g++'s memory is less than the time to look for it is worth: 6 % of all compiling.
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    target_compile_options(ripplenotch_options INTERFACE "SHELL:--param ggc-min-heapsize=1048576")  # KiB
endif()
# A linker that reads its files in parallel: after an edit the linking of the program and the tests took longer than compiling.
option(RIPPLENOTCH_FAST_LINKER "Link with mold or lld where they are there, for those who edit and try" OFF)
if(RIPPLENOTCH_FAST_LINKER)
    find_program(RIPPLENOTCH_MOLD mold)
    find_program(RIPPLENOTCH_LLD ld.lld)
    if(RIPPLENOTCH_MOLD)
        add_link_options(-fuse-ld=mold)
    elseif(RIPPLENOTCH_LLD)
        add_link_options(-fuse-ld=lld)
    endif()
endif()
if(RIPPLENOTCH_WERROR)
    target_compile_options(ripplenotch_options INTERFACE -Werror)
endif()
if(RIPPLENOTCH_FUZZ)
    target_compile_options(ripplenotch_options INTERFACE -fsanitize=fuzzer-no-link,float-cast-overflow)
    target_link_options(ripplenotch_options INTERFACE -fsanitize=fuzzer-no-link,float-cast-overflow)
endif()
if(RIPPLENOTCH_SANITIZE)
    set(sanitizers address,undefined)
    if(RIPPLENOTCH_SANITIZE STREQUAL thread)
        set(sanitizers thread)
    endif()
    target_compile_options(ripplenotch_options INTERFACE
        -fsanitize=${sanitizers} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(ripplenotch_options INTERFACE -fsanitize=${sanitizers})
    # Instrumented code makes g++ 12 see uninitialised members inside std::regex; the dev preset keeps the warning.
    if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
        target_compile_options(ripplenotch_options INTERFACE -Wno-maybe-uninitialized)
    endif()
endif()
