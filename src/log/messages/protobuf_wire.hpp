// SPDX-License-Identifier: MIT
#pragma once
// The bytes of Protobuf messages: fields, each behind its number and the kind of its size (protobuf.dev,
// "Encoding").

#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

struct WireField {
    enum class Size { varint = 0, eight = 1, counted = 2, four = 5 };
    std::uint32_t number = 0;
    Size size = Size::varint;
    std::uint64_t bits = 0;  ///< but for counted ones
    std::string_view bytes;  ///< of counted ones
};

class WireCursor {
  public:
    explicit WireCursor(std::string_view bytes) : bytes_(bytes) {}
    [[nodiscard]] bool at_end() const { return bytes_.empty(); }

    /// Throws DataError, without a source's name, where the bytes end or are no field.
    WireField next() {
        const std::uint64_t tag = varint();
        WireField field;
        field.number = static_cast<std::uint32_t>(tag >> 3);
        if (tag >> 32 != 0 || field.number == 0)
            raise<DataError>("a field without a number in a message of Protobuf");
        switch (tag & 7) {
            case 0:
                field.bits = varint();
                break;
            case 1:
                field.bits = fixed(8);
                break;
            case 2:
                field.bytes = counted(varint());
                break;
            case 5:
                field.bits = fixed(4);
                break;
            default:
                raise<DataError>("field {} of a group, which is not read", field.number);
        }
        field.size = static_cast<WireField::Size>(tag & 7);
        return field;
    }
    std::uint64_t varint() {
        std::uint64_t value = 0;
        for (unsigned shift = 0; shift < 64; shift += 7) {
            const auto byte = static_cast<unsigned char>(counted(1)[0]);
            value |= std::uint64_t{byte & 0x7fU} << shift;
            if ((byte & 0x80U) == 0) return value;
        }
        raise<DataError>("a whole number of more than ten bytes in a message of Protobuf");
    }
    /// Little endian, of 4 or 8 bytes.
    std::uint64_t fixed(std::size_t size) {
        const std::string_view bytes = counted(size);
        std::uint64_t value = 0;
        for (std::size_t i = size; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[i]);
        return value;
    }

  private:
    std::string_view counted(std::uint64_t size) {
        if (size > bytes_.size())
            raise<DataError>("a message of Protobuf that ends, expected {} bytes more", size - bytes_.size());
        const std::string_view bytes = bytes_.substr(0, size);
        bytes_.remove_prefix(size);
        return bytes;
    }

    std::string_view bytes_;
};

}  // namespace ripplenotch
