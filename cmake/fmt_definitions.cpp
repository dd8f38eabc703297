// SPDX-License-Identifier: MIT
// What fmt's shared library defines, from the header that it is made of, for a program linked without shared
// libraries. Templates are instantiated for what our own files leave to the library. Another version of fmt
// may leave more to it: cmake/static_program.cmake links cmake/fmt_check.cpp with this file, and does without
// it then.
#include <fmt/format-inl.h>

namespace fmt::detail {

template dragonbox::decimal_fp<float> dragonbox::to_decimal(float) noexcept;
template dragonbox::decimal_fp<double> dragonbox::to_decimal(double) noexcept;
template thousands_sep_result<char> thousands_sep_impl(locale_ref);
template char decimal_point_impl(locale_ref);
template void buffer<char>::append(const char*, const char*);
template void vformat_to(buffer<char>&, string_view, basic_format_args<buffer_context<char>>, locale_ref);

}  // namespace fmt::detail
