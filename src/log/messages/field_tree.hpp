// SPDX-License-Identifier: MIT
#pragma once
// Messages that name their fields (JSON, Protobuf): a walk through one tells what stands where, and a tree of
// the fields of the first message says which of it is kept from the next.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "log/messages/message_records.hpp"

namespace ripplenotch {

/// How deep the records and lists of a message may lie in one another.
inline constexpr std::size_t deepest_field = 32;

struct FieldNumber {
    double value = 0.0;
    std::int64_t whole = 0;  ///< the same, where it is_whole
    bool is_whole = false;
};

/// What a walk through a message meets, in the order in which it stands there.
class FieldVisitor {
  public:
    virtual ~FieldVisitor() = default;
    /// What comes until leave() is the value of this field of the record that is visited.
    virtual void field(std::string_view name) = 0;
    /// What comes until leave() is the next element of the list that is visited.
    virtual void element() = 0;
    virtual void leave() = 0;
    virtual void number(const FieldNumber& number) = 0;
    virtual void text(std::string_view text) = 0;
};

class FieldWalk {
  public:
    virtual ~FieldWalk() = default;
    /// Throws DataError, without a source's name, where the bytes are no such message.
    virtual void walk(std::string_view message, FieldVisitor& visitor) const = 0;
};

/// Messages in JSON, an object each. Whether a schema says more about them makes no difference: numbers say
/// that they are.
[[nodiscard]] std::shared_ptr<const FieldWalk> json_walk();
/// Messages in Protobuf, of a type that `descriptor_set` defines. Fields of proto3 that are not written are
/// 0, others are not there. Throws DataError, without a source's name, where the type is not defined.
[[nodiscard]] std::shared_ptr<const FieldWalk> protobuf_walk(std::string_view descriptor_set,
                                                             const std::string& type);

/// lay_out_message() of encodings with a walk. Numbers are 64-bit floats, but for whole ones beyond 2^53.
[[nodiscard]] MessageLayout lay_out_fields(std::shared_ptr<const FieldWalk> walk, std::string_view first);

}  // namespace ripplenotch
