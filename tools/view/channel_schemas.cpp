#include "tools/view/channel_schemas.hpp"

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <utility>

namespace crspf::view {
namespace {

/// Of its own: the names are short.
namespace schema {

using Json = nlohmann::ordered_json;
using Property = std::pair<const char*, Json>;

/// All of its properties are always there.
Json object(const char* title, std::initializer_list<Property> properties) {
    Json schema{{"title", title}, {"type", "object"}, {"properties", Json::object()}, {"required", Json::array()}};
    for (const auto& [name, type] : properties) {
        schema["properties"][name] = type;
        schema["required"].push_back(name);
    }
    return schema;
}

Json array_of(const Json& items) {
    return {{"type", "array"}, {"items", items}};
}

Json number() {
    return {{"type", "number"}};
}

Json text() {
    return {{"type", "string"}};
}

Json boolean() {
    return {{"type", "boolean"}};
}

Json count() {
    return {{"type", "integer"}, {"minimum", 0}};
}

Json bytes() {
    return {{"type", "string"}, {"contentEncoding", "base64"}};
}

Json time() {
    return object("time",
                  {{"sec", count()}, {"nsec", {{"type", "integer"}, {"minimum", 0}, {"maximum", 999'999'999}}}});
}

/// A number for each name, counted from 0.
Json one_of(const char* title, std::initializer_list<const char*> names) {
    Json choices = Json::array();
    for (const char* const name : names) {
        choices.push_back({{"title", name}, {"const", choices.size()}});
    }
    return {{"title", title}, {"oneOf", std::move(choices)}};
}

Json vector3() {
    return object("foxglove.Vector3", {{"x", number()}, {"y", number()}, {"z", number()}});
}

Json quaternion() {
    return object("foxglove.Quaternion", {{"x", number()}, {"y", number()}, {"z", number()}, {"w", number()}});
}

Json pose() {
    return object("foxglove.Pose", {{"position", vector3()}, {"orientation", quaternion()}});
}

Json packed_fields() {
    return array_of(object("foxglove.PackedElementField",
                           {{"name", text()},
                            {"offset", count()},
                            {"type", one_of("foxglove.NumericType", {"UNKNOWN", "UINT8", "INT8", "UINT16", "INT16",
                                                                     "UINT32", "INT32", "FLOAT32", "FLOAT64"})}}));
}

Json frame_transforms() {
    return object("foxglove.FrameTransforms",
                  {{"transforms", array_of(object("foxglove.FrameTransform", {{"timestamp", time()},
                                                                              {"parent_frame_id", text()},
                                                                              {"child_frame_id", text()},
                                                                              {"translation", vector3()},
                                                                              {"rotation", quaternion()}}))}});
}

Json pose_in_frame() {
    return object("foxglove.PoseInFrame", {{"timestamp", time()}, {"frame_id", text()}, {"pose", pose()}});
}

Json poses_in_frame() {
    return object("foxglove.PosesInFrame", {{"timestamp", time()}, {"frame_id", text()}, {"poses", array_of(pose())}});
}

Json point_cloud() {
    return object("foxglove.PointCloud", {{"timestamp", time()},
                                          {"frame_id", text()},
                                          {"pose", pose()},
                                          {"point_stride", count()},
                                          {"fields", packed_fields()},
                                          {"data", bytes()}});
}

Json grid() {
    return object("foxglove.Grid", {{"timestamp", time()},
                                    {"frame_id", text()},
                                    {"pose", pose()},
                                    {"column_count", count()},
                                    {"cell_size", object("foxglove.Vector2", {{"x", number()}, {"y", number()}})},
                                    {"row_stride", count()},
                                    {"cell_stride", count()},
                                    {"fields", packed_fields()},
                                    {"data", bytes()}});
}

Json map_tiles() {
    Json cell{{"type", "integer"}};
    return object("crspf.MapTiles",
                  {{"timestamp", time()},
                   {"fresh", boolean()},
                   {"resolution_m", number()},
                   {"side_cells", count()},
                   {"tiles", array_of(object("crspf.Tile", {{"x", cell}, {"y", cell}, {"data", bytes()}}))}});
}

Json scan_result() {
    return object(
        "crspf.ScanResult",
        {{"timestamp", time()},
         {"x_m", number()},
         {"y_m", number()},
         {"heading_rad", number()},
         {"covariance", array_of(number())},
         {"M", number()},
         {"m", number()},
         {"thresholds",
          object("crspf.Thresholds",
                 {{"result_on", number()}, {"result_off", number()}, {"draw_on", number()}, {"draw_off", number()}})},
         {"matched", boolean()},
         {"result", boolean()},
         {"draw", boolean()},
         {"lost", boolean()},
         {"degenerate", boolean()},
         {"rays", count()},
         {"critical_rays", count()},
         {"evaluations", count()},
         {"range_m", number()},
         {"range_rad", number()}});
}

/// What else stands in it is the service's own (docs/service.md).
Json status() {
    return object("crspf.Status", {{"timestamp", time()}});
}

Json diagnostic_array() {
    const Json value = object("diagnostic_msgs/KeyValue", {{"key", text()}, {"value", text()}});
    return object("diagnostic_msgs/DiagnosticArray",
                  {{"header", object("std_msgs/Header", {{"stamp", time()}, {"frame_id", text()}})},
                   {"status", array_of(object("diagnostic_msgs/DiagnosticStatus", {{"level", count()},
                                                                                   {"name", text()},
                                                                                   {"message", text()},
                                                                                   {"hardware_id", text()},
                                                                                   {"values", array_of(value)}}))}});
}

Json log() {
    return object("foxglove.Log",
                  {{"timestamp", time()},
                   {"level", one_of("foxglove.LogLevel", {"UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"})},
                   {"message", text()},
                   {"name", text()},
                   {"file", text()},
                   {"line", count()}});
}

}  // namespace schema

}  // namespace

std::vector<ChannelInfo> channel_table() {
    const std::initializer_list<schema::Property> table{
        {"/tf", schema::frame_transforms()},
        {"/pose", schema::pose_in_frame()},
        {"/path", schema::poses_in_frame()},
        {"/scan", schema::point_cloud()},
        {"/map", schema::grid()},
        {"/map/tiles", schema::map_tiles()},
        {"/match", schema::scan_result()},
        {"/status", schema::status()},
        {"/diagnostics", schema::diagnostic_array()},
        {"/log", schema::log()},
    };
    std::vector<ChannelInfo> channels;
    for (const auto& [topic, type] : table) {
        channels.push_back({.topic = topic, .schema_name = type["title"].get<std::string>(), .schema = type.dump()});
    }
    return channels;
}

}  // namespace crspf::view
