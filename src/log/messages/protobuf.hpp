// SPDX-License-Identifier: MIT
#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "log/messages/field_tree.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

/// Messages in Protobuf, of a type that `descriptor_set` defines. Fields of proto3 that are not written are
/// 0, others are not there. Throws DataError, without a source's name, where the type is not defined.
[[nodiscard]] std::shared_ptr<const FieldWalk> protobuf_walk(std::string_view descriptor_set,
                                                             const std::string& type);

}  // namespace ripplenotch
