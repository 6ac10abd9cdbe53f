// The installed package, used as the README shows it: places a pattern, grows a flower, writes it.
#include <anthesis/base/file.h>
#include <anthesis/exchange/glb.h>
#include <anthesis/exchange/species_file.h>
#include <anthesis/fate/cone.h>
#include <anthesis/phyllotaxis/vogel.h>

#include <cstdio>
#include <numbers>
#include <vector>

int main() {
  std::vector<anthesis::Vec2> florets_mm(82);
  anthesis::place_spiral({}, florets_mm);
  const double cone_rad = 38.0 * std::numbers::pi / 180.0;
  std::printf("%zu rays on the disc\n", anthesis::count_with_room(florets_mm, {}, cone_rad));

  const auto species = anthesis::find_species("sunflower");
  const auto flower = species.and_then([](const auto& s) { return anthesis::Development::grow(s, {.seed = 2}); });
  const auto glb = flower.and_then([](const auto& f) { return anthesis::to_glb(f); });
  if (!glb || anthesis::write_file("sunflower.glb", *glb)) {
    std::puts(glb ? "cannot write" : anthesis::to_string(glb.error()).c_str());
    return 1;
  }
  std::printf("%zu organs, %zu bytes\n", flower->organs().size(), glb->size());
}
