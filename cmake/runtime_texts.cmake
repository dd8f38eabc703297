# The runtimes of exported code are C, which the tool compiles as it stands and writes out: runtime_text.hpp has each file of
# src/design/runtime as a text of its name.
function(ripplenotch_runtime_texts target)
    file(GLOB runtimes CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/design/runtime/*.h)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${runtimes})
    set(texts "#pragma once\n#include <string_view>\nnamespace ripplenotch::runtime_text {\n")
    foreach(runtime IN LISTS runtimes)
        file(READ ${runtime} text)
        get_filename_component(name ${runtime} NAME_WE)
        string(APPEND texts "inline constexpr std::string_view ${name} = R\"c(${text})c\";\n")
    endforeach()
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/runtime/runtime_text.hpp CONTENT "${texts}}\n" @ONLY)
    target_include_directories(${target} PRIVATE ${PROJECT_BINARY_DIR}/runtime)
endfunction()
