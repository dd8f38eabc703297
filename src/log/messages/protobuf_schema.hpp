// SPDX-License-Identifier: MIT
#pragma once
// Types of Protobuf messages, as recordings carry them: a FileDescriptorSet (descriptor.proto of Protobuf).

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace ripplenotch {

struct ProtobufField {
    /// As numbered in descriptor.proto.
    enum class Type : std::uint32_t {
        float64 = 1,
        float32 = 2,
        int64 = 3,
        uint64 = 4,
        int32 = 5,
        fixed64 = 6,
        fixed32 = 7,
        boolean = 8,
        text = 9,
        group = 10,
        message = 11,
        bytes = 12,
        uint32 = 13,
        enumeration = 14,
        sfixed32 = 15,
        sfixed64 = 16,
        sint32 = 17,
        sint64 = 18
    };
    std::uint32_t number = 0;
    std::string name;
    Type type = Type::float64;
    bool repeated = false;
    bool zero_if_absent = false;  ///< proto3: what is not written is 0; else it is not there
    std::size_t inner = 0;        ///< of a message: its place among the types
};

using ProtobufType = std::vector<ProtobufField>;

struct ProtobufTypes {
    std::vector<ProtobufType> types;  ///< the first is the one that was asked for
};

/// Throws DataError, without a source's name, on bytes that are no such set, and where a type is not in it.
[[nodiscard]] ProtobufTypes parse_protobuf_schema(std::string_view descriptor_set, const std::string& type);

}  // namespace ripplenotch
