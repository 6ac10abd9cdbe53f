// The judge of `anthesis check`: counts the pairs of triangles that cross in a PLY file of ours, with CGAL's box
// intersection and exact predicates and by the rules of its Polygon_mesh_processing::self_intersections, applied to
// triangles that are neighbours where corners are at equal places.
//
//   g++ -std=c++17 -O2 -DNDEBUG -o cgal_judge cgal_judge.cpp -lgmp -lmpfr
//   cgal_judge flower.ply        prints "N crossings, D degenerate"; exit status 0 for none, 1 for some, 2 for no mesh
//
// Nothing here is part of the product.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::size_t>;
using Face = std::array<std::size_t, 3>;

struct Mesh {
  std::vector<Point> points;  // each place once
  std::vector<Face> faces;
};

// Binary little-endian, x y z first and float, other vertex properties of known size, faces a list of uchar and int.
bool read(const char* path, Mesh& mesh) {
  std::ifstream file(path, std::ios::binary);
  std::string line;
  std::size_t vertices = 0;
  std::size_t faces = 0;
  std::size_t vertex_bytes = 0;
  bool in_vertex = false;
  bool little = false;
  while (std::getline(file, line) && line != "end_header") {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "format") {
      words >> word;
      little = word == "binary_little_endian";
    } else if (word == "element") {
      std::string name;
      std::size_t count = 0;
      words >> name >> count;
      in_vertex = name == "vertex";
      (in_vertex ? vertices : faces) = count;
    } else if (word == "property" && in_vertex) {
      words >> word;
      vertex_bytes += word == "uchar" ? 1 : 4;
    }
  }
  if (!file || !little || vertex_bytes < 12) {
    return false;
  }
  std::map<std::array<float, 3>, std::size_t> places;
  std::vector<std::size_t> place_of(vertices);
  std::vector<char> raw(vertex_bytes);
  for (std::size_t i = 0; i < vertices; ++i) {
    file.read(raw.data(), static_cast<std::streamsize>(raw.size()));
    std::array<float, 3> p;
    std::memcpy(p.data(), raw.data(), 12);
    const auto [place, is_new] = places.try_emplace(p, mesh.points.size());  // -0 and 0 compare equal
    if (is_new) {
      mesh.points.emplace_back(p[0], p[1], p[2]);
    }
    place_of[i] = place->second;
  }
  for (std::size_t i = 0; i < faces; ++i) {
    std::array<char, 13> face;
    file.read(face.data(), face.size());
    std::array<std::uint32_t, 3> corners;
    std::memcpy(corners.data(), face.data() + 1, 12);
    if (face[0] != 3 || *std::max_element(corners.begin(), corners.end()) >= vertices) {
      return false;
    }
    mesh.faces.push_back({place_of[corners[0]], place_of[corners[1]], place_of[corners[2]]});
  }
  return static_cast<bool>(file);
}

// As CGAL's self_intersections decides for two faces of a surface mesh.
bool cross(const Mesh& mesh, const Face& f, const Face& g) {
  std::vector<int> common_in_f;
  std::vector<int> common_in_g;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (f[i] == g[j]) {
        common_in_f.push_back(i);
        common_in_g.push_back(j);
      }
    }
  }
  const auto point = [&mesh](const Face& face, int k) { return mesh.points[face[k % 3]]; };
  const Kernel::Triangle_3 one(point(f, 0), point(f, 1), point(f, 2));
  const Kernel::Triangle_3 other(point(g, 0), point(g, 1), point(g, 2));
  switch (common_in_f.size()) {
    case 0:
      return CGAL::do_intersect(one, other);
    case 1: {
      const int i = common_in_f[0];
      const int j = common_in_g[0];
      return CGAL::do_intersect(one, Kernel::Segment_3(point(g, j + 1), point(g, j + 2))) ||
             CGAL::do_intersect(other, Kernel::Segment_3(point(f, i + 1), point(f, i + 2)));
    }
    case 2: {
      const Point a = point(f, common_in_f[0]);
      const Point b = point(f, common_in_f[1]);
      const Point c = point(f, 3 - common_in_f[0] - common_in_f[1]);
      const Point d = point(g, 3 - common_in_g[0] - common_in_g[1]);
      return CGAL::coplanar(a, b, c, d) && CGAL::coplanar_orientation(a, b, c, d) == CGAL::POSITIVE;
    }
    default:
      return true;
  }
}

}  // namespace

int main(int argc, char** argv) {
  Mesh mesh;
  if (argc != 2 || !read(argv[1], mesh)) {
    std::cerr << "cgal_judge: give one PLY file of anthesis\n";
    return 2;
  }
  std::vector<Box> boxes;
  std::size_t degenerate = 0;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const auto [a, b, c] = mesh.faces[i];
    if (CGAL::collinear(mesh.points[a], mesh.points[b], mesh.points[c])) {
      ++degenerate;  // as self_intersections does, which tests them against nothing
    } else {
      boxes.emplace_back(mesh.points[a].bbox() + mesh.points[b].bbox() + mesh.points[c].bbox(), i);
    }
  }
  std::size_t crossings = 0;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& one, const Box& other) {
    crossings += cross(mesh, mesh.faces[one.info()], mesh.faces[other.info()]) ? 1 : 0;
  });
  std::cout << crossings << " crossings, " << degenerate << " degenerate\n";
  return crossings > 0 ? 1 : 0;
}
