// SPDX-License-Identifier: MIT
#include "log/messages/protobuf_message.hpp"

#include <algorithm>
#include <bit>

#include "log/messages/protobuf_schema.hpp"
#include "log/messages/protobuf_wire.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

using Type = ProtobufField::Type;
using Size = WireField::Size;

Size size_of(Type type) {
    switch (type) {
        case Type::float64:
        case Type::fixed64:
        case Type::sfixed64:
            return Size::eight;
        case Type::float32:
        case Type::fixed32:
        case Type::sfixed32:
            return Size::four;
        case Type::text:
        case Type::bytes:
        case Type::message:
        case Type::group:
            return Size::counted;
        default:
            return Size::varint;
    }
}

bool holds_number(Type type) { return size_of(type) != Size::counted; }

FieldNumber whole_field(std::int64_t value) { return {static_cast<double>(value), value, true}; }

FieldNumber number_of(Type type, std::uint64_t bits) {
    switch (type) {
        case Type::float64:
            return {std::bit_cast<double>(bits), 0, false};
        case Type::float32:
            return {static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits))), 0, false};
        case Type::uint64:
        case Type::fixed64:
            if (bits > static_cast<std::uint64_t>(INT64_MAX)) return {static_cast<double>(bits), 0, false};
            return whole_field(static_cast<std::int64_t>(bits));
        case Type::uint32:
        case Type::fixed32:
            return whole_field(static_cast<std::uint32_t>(bits));
        case Type::int32:
        case Type::sfixed32:
        case Type::enumeration:
            return whole_field(static_cast<std::int32_t>(static_cast<std::uint32_t>(bits)));
        case Type::sint32:
        case Type::sint64:
            return whole_field(static_cast<std::int64_t>((bits >> 1) ^ (~(bits & 1) + 1)));
        case Type::boolean:
            return whole_field(bits != 0 ? 1 : 0);
        default:
            return whole_field(static_cast<std::int64_t>(bits));
    }
}

class ProtobufWalk final : public FieldWalk {
  public:
    explicit ProtobufWalk(ProtobufTypes types) : types_(std::move(types)) {}
    void walk(std::string_view message, FieldVisitor& visitor) const override {
        record(types_.types.front(), message, visitor, 0);
    }

  private:
    void record(const ProtobufType& type, std::string_view bytes, FieldVisitor& visitor,
                std::size_t depth) const {
        if (depth == deepest_field)
            raise<DataError>("messages deeper than {} in a message of Protobuf", deepest_field);
        std::vector<bool> seen(type.size());
        for (WireCursor cursor(bytes); !cursor.at_end();) {
            const WireField one = cursor.next();
            const auto field = std::find_if(type.begin(), type.end(), [&](const ProtobufField& known) {
                return known.number == one.number;
            });
            if (field == type.end()) continue;  // of a later version of the type
            seen[static_cast<std::size_t>(field - type.begin())] = true;
            visitor.field(field->name);
            values(*field, one, visitor, depth);
            visitor.leave();
        }
        for (std::size_t i = 0; i < type.size(); ++i) {
            if (seen[i] || !type[i].zero_if_absent || !holds_number(type[i].type)) continue;
            visitor.field(type[i].name);
            visitor.number({0.0, 0, true});
            visitor.leave();
        }
    }
    void values(const ProtobufField& field, const WireField& one, FieldVisitor& visitor,
                std::size_t depth) const {
        if (field.repeated && holds_number(field.type) && one.size == Size::counted) {
            for (WireCursor packed(one.bytes); !packed.at_end();) {
                visitor.element();
                visitor.number(number_of(field.type, next_of(field.type, packed)));
                visitor.leave();
            }
            return;
        }
        if (one.size != size_of(field.type))
            raise<DataError>("the field {} in bytes of another type than the recording defines", field.name);
        if (field.repeated) visitor.element();
        if (field.type == Type::message)
            record(types_.types[field.inner], one.bytes, visitor, depth + 1);
        else if (field.type == Type::text)
            visitor.text(one.bytes);
        else if (holds_number(field.type))
            visitor.number(number_of(field.type, one.bits));
        if (field.repeated) visitor.leave();
    }
    static std::uint64_t next_of(Type type, WireCursor& packed) {
        const Size size = size_of(type);
        return size == Size::varint ? packed.varint() : packed.fixed(size == Size::eight ? 8 : 4);
    }

    ProtobufTypes types_;
};

}  // namespace

std::shared_ptr<const FieldWalk> protobuf_walk(std::string_view descriptor_set, const std::string& type) {
    return std::make_shared<ProtobufWalk>(parse_protobuf_schema(descriptor_set, type));
}

}  // namespace ripplenotch
