#include "target_reader.h"

namespace outcrop {

RockTarget read_target(JsonReader& material) {
  RockTarget target;
  const Json* const json = material.child("target");
  if (!json) return target;
  JsonReader reader(*json);
  if (reader.has("block_volume"))
    target.block_volume = reader.number("block_volume", 0.0, {.lo = 0.0, .hi = 1e9, .open_lo = true});
  if (reader.has("jv")) target.jv = reader.number("jv", 0.0, {.lo = 0.0, .hi = 1e5, .open_lo = true});
  if (reader.has("rqd")) target.rqd = reader.number("rqd", 0.0, {0.0, 100.0});
  reader.finish();
  if (!target.any()) json->fail("\"target\": \"block_volume\", \"jv\" or \"rqd\"", "none of them");
  return target;
}

}  // namespace outcrop
