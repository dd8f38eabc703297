// SPDX-License-Identifier: MIT
#include "log/messages/ros_schema.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr int deepest_message = 16;
constexpr std::size_t longest_array = 100000, most_fields = 10000;

struct Primitive {
    std::string_view name;
    char kind;
    std::size_t size;
};
constexpr std::array primitives = {
    Primitive{"bool", 'u', 1},    Primitive{"byte", 'u', 1},   Primitive{"char", 'u', 1},
    Primitive{"int8", 'i', 1},    Primitive{"uint8", 'u', 1},  Primitive{"int16", 'i', 2},
    Primitive{"uint16", 'u', 2},  Primitive{"int32", 'i', 4},  Primitive{"uint32", 'u', 4},
    Primitive{"int64", 'i', 8},   Primitive{"uint64", 'u', 8}, Primitive{"float32", 'f', 4},
    Primitive{"float64", 'f', 8},
};

// sensor_msgs/msg/JointState and sensor_msgs/JointState are one.
std::string plain_name(std::string_view type) {
    std::string name(type);
    if (const std::size_t at = name.find("/msg/"); at != std::string::npos) name.erase(at, 4);
    return name;
}

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

class SchemaParser {
  public:
    SchemaParser(std::string_view schema, const std::string& type) {
        std::string name = plain_name(type);
        std::string_view rest = schema;
        while (!rest.empty()) {
            const std::size_t end = std::min(rest.find('\n'), rest.size());
            const std::string_view line = trimmed(rest.substr(0, end));
            rest.remove_prefix(std::min(end + 1, rest.size()));
            if (line.starts_with("====")) continue;
            if (line.starts_with("MSG:")) {
                name = plain_name(trimmed(line.substr(4)));
                definitions_[name];
                continue;
            }
            definitions_[name].push_back(line);
        }
    }
    RosType record(const std::string& name, int depth) {
        if (depth > deepest_message)
            raise<DataError>("the type {} holds itself, or types deeper than {}", name, deepest_message);
        const auto found = definitions_.find(name);
        if (found == definitions_.end())
            raise<DataError>("the type {} is not defined in the recording", name);
        RosType type;
        type.kind = RosType::Kind::record;
        for (const std::string_view line : found->second) read_line(line, name, type, depth);
        return type;
    }

  private:
    void read_line(std::string_view line, const std::string& name, RosType& into, int depth) {
        line = trimmed(line.substr(0, std::min(line.find('#'), line.size())));
        if (line.empty()) return;
        const std::size_t blank = line.find_first_of(" \t");
        if (blank == std::string_view::npos)
            raise<DataError>("the type {} has a line '{}', expected a field", name, line);
        const std::string_view type = line.substr(0, blank);
        const std::string_view rest = trimmed(line.substr(blank));
        const std::size_t end = rest.find_first_of(" \t=");
        const std::string_view word = rest.substr(0, end);
        // A constant: NAME=value.
        if (end != std::string_view::npos && trimmed(rest.substr(end)).starts_with('=')) return;
        if (++fields_ > most_fields)
            raise<DataError>("the type {} has more than {} fields", name, most_fields);
        RosField field;
        field.name = word;
        field.type = type_of(read_count(type, field), name, depth);
        into.fields.push_back(std::move(field));
    }
    // Without "[]", "[3]", "[<=3]" and the "<=10" of a string.
    static std::string_view read_count(std::string_view type, RosField& field) {
        const std::size_t bracket = type.find('[');
        std::string_view base = type.substr(0, bracket);
        base = base.substr(0, base.find("<="));
        if (bracket == std::string_view::npos) return base;
        const std::string_view inside = type.substr(bracket + 1, type.size() - bracket - 2);
        const auto number = parse_number(inside);
        field.count = number ? RosField::Count::fixed : RosField::Count::any;
        if (number && !(*number >= 0.0 && *number <= static_cast<double>(longest_array)))
            raise<DataError>("an array {} is longer than {}", type, longest_array);
        if (number) field.fixed = static_cast<std::size_t>(*number);
        return base;
    }
    RosType type_of(std::string_view word, const std::string& inside, int depth) {
        RosType type;
        const auto primitive = std::find_if(primitives.begin(), primitives.end(),
                                            [&](const Primitive& one) { return one.name == word; });
        if (primitive != primitives.end()) {
            type.number = primitive->kind;
            type.size = primitive->size;
            return type;
        }
        if (word == "string" || word == "wstring") {
            type.kind = word == "string" ? RosType::Kind::text : RosType::Kind::wide_text;
            return type;
        }
        const std::string name = full_name(plain_name(word), inside);
        if (name == "builtin_interfaces/Time" || name == "builtin_interfaces/Duration") {
            type.kind = RosType::Kind::stamp;
            return type;
        }
        return record(name, depth + 1);
    }
    std::string full_name(const std::string& name, const std::string& inside) const {
        if (name == "time" || name == "Time") return "builtin_interfaces/Time";
        if (name == "duration" || name == "Duration") return "builtin_interfaces/Duration";
        if (name.find('/') != std::string::npos) return name;
        const std::string beside = inside.substr(0, inside.find('/') + 1) + name;
        return definitions_.count(beside) == 0 && name == "Header" ? "std_msgs/Header" : beside;
    }

    std::map<std::string, std::vector<std::string_view>> definitions_;
    std::size_t fields_ = 0;
};

struct KnownSchema {
    std::string_view type, schema;
};
// Recordings before ROS 2 Iron do not carry definitions. These are the fields of common types, in their
// order.
constexpr std::string_view header_schema =
    "\n====\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n";
constexpr std::array known_schemas = {
    KnownSchema{
        "sensor_msgs/JointState",
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"},
    KnownSchema{
        "geometry_msgs/WrenchStamped",
        "std_msgs/Header header\ngeometry_msgs/Wrench wrench\n====\nMSG: geometry_msgs/Wrench\n"
        "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n====\nMSG: geometry_msgs/Vector3\n"
        "float64 x\nfloat64 y\nfloat64 z\n"},
    KnownSchema{"std_msgs/Float64", "float64 data\n"},
    KnownSchema{"std_msgs/Float32", "float32 data\n"},
    KnownSchema{
        "std_msgs/Float64MultiArray",
        "std_msgs/MultiArrayLayout layout\nfloat64[] data\n====\nMSG: std_msgs/MultiArrayLayout\n"
        "std_msgs/MultiArrayDimension[] dim\nuint32 data_offset\n====\nMSG: std_msgs/MultiArrayDimension\n"
        "string label\nuint32 size\nuint32 stride\n"},
};

}  // namespace

RosType parse_ros_schema(std::string_view schema, const std::string& type) {
    const std::string whole = std::string(schema) + std::string(header_schema);
    return SchemaParser(schema.find("MSG: std_msgs/") != std::string_view::npos ? schema : whole, type)
        .record(plain_name(type), 0);
}

std::string_view known_ros_schema(std::string_view type) {
    const std::string name = plain_name(type);
    for (const KnownSchema& known : known_schemas)
        if (known.type == name) return known.schema;
    return {};
}

}  // namespace ripplenotch
