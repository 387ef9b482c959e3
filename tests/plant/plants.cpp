// SPDX-License-Identifier: Apache-2.0
#include "plant/plants.hpp"

#include "support/lead_rubber.hpp"

namespace rths::plant::test {

sim::Bearing lead_rubber() { return rths::test::plain_lead_rubber(); }

const LargePlant& large_plant() {
  static const LargePlant plant = [] {
    LargePlant made;
    made.mesh = mesh_of(ant_with(5'676));
    made.structure = assemble(made.mesh);
    made.bearings = BearingSet::all_of(lead_rubber(), made.structure.bearings.size());
    return made;
  }();
  return plant;
}

const Basis& large_basis() {
  static const Basis basis = make_basis(large_plant().structure, large_plant().bearings, {});
  return basis;
}

AntMesh boxes(const BoxDesign& design) {
  AntMesh mesh;
  const auto part = PlantPart::Basemat;
  mesh.densities[static_cast<std::size_t>(part)] = design.density;
  mesh.moduli[static_cast<std::size_t>(part)] = design.modulus;
  mesh.poisson_ratio = design.poisson_ratio;
  // Four nodes in each plane x = constant: lower, lower, upper, upper.
  for (int plane = 0; plane <= design.elements; ++plane)
    for (std::size_t corner = 0; corner < 4; ++corner) {
      MeshNode node;
      node.place = {plane * kBoxLong, corner % 2 == 0 ? 0 : kBoxLat, corner < 2 ? 0 : kBoxHeight};
      for (Index& dof : node.dofs)
        dof = static_cast<Index>(kDirections * mesh.nodes.size()) + (&dof - node.dofs.data());
      if (corner < 2) mesh.bearings.push_back(mesh.nodes.size());
      mesh.nodes.push_back(node);
    }
  for (int i = 0; i < design.elements; ++i) {
    const auto left = static_cast<std::size_t>(4 * i), right = left + 4;
    mesh.solids.push_back(
        {{left, right, right + 1, left + 1, left + 2, right + 2, right + 3, left + 3}, part});
  }
  mesh.floors = {{"top", mesh.nodes.size() - 1}};
  return mesh;
}

}  // namespace rths::plant::test
