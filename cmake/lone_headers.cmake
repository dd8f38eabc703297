# Each public header compiled by itself, twice included, without precompiled headers: where files are compiled alone (preset
# `odr`). Elsewhere tests/house/test_headers.py looks the names up, at no cost.
function(ripplenotch_lone_headers folder)
    file(GLOB_RECURSE headers RELATIVE ${folder} CONFIGURE_DEPENDS ${folder}/*.hpp)
    foreach(header IN LISTS headers)
        string(MAKE_C_IDENTIFIER ${header} name)
        file(CONFIGURE OUTPUT lone_headers/${name}.cpp CONTENT "#include <${header}>\n#include <${header}>\n")
        list(APPEND including ${CMAKE_CURRENT_BINARY_DIR}/lone_headers/${name}.cpp)
    endforeach()
    add_library(lone_headers OBJECT ${including})
    target_link_libraries(lone_headers PRIVATE ripplenotch::ripplenotch ripplenotch_options)
endfunction()
