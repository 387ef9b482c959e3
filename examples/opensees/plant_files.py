"""Writes a model of OpenSees as the files of a plant: `[plant] model = "files"`.

    import plant_files
    plant_files.write("plant", bearings=[1, 2, 5], floors={"roof": 812}, without=[9001, 9002, 9003])

as the last call of a script that has built the model: it fixes nodes and makes analyses of its own. The model has three
dimensions and nodes of 3 or 6 degrees of freedom. The stiffness is the tangent in the current state, exact for any element;
OpenSees' own handler eliminates equalDOF, rigidLink and rigidDiaphragm. Degrees of freedom without mass, such as rotations,
are condensed, which is exact. Needs NumPy.
"""
import pathlib

import numpy as np
import openseespy.opensees as ops

BLOCK = 2000  # degrees of freedom of a matrix that OpenSees prints, which is dense
MOST_WITHOUT_MASS = 4000  # condensed densely
DIRECTIONS = "xyz"


def write(folder, bearings, floors=None, without=(), length_unit_m=1.0, force_unit_N=1.0):
    """Writes k.mtx, m.mtx, nodes.csv, bearings.csv and floors.csv.

    bearings        tags of the nodes that stand on bearings
    floors          {name: tag of a node} whose acceleration is recorded
    without         tags of the elements to leave out: the bearings of the model, and the specimen
    length_unit_m, force_unit_N   of the model: 0.0254 and 4448.22 for inches and kips

    Returns the numbers of degrees of freedom that were written and condensed. Raises ValueError, naming the node, if a
    bearing or a floor does not move in all directions, if masses are coupled, and if the structure is held by anything but
    its bearings.
    """
    if ops.getNDM() != [3]:
        raise ValueError(f"the model has {ops.getNDM()[0]} dimensions, expected 3")
    for tag in without:
        ops.remove("element", tag)
    model = Model(length_unit_m, force_unit_N)
    for what, tag in [(f"bearing {tag}", tag) for tag in bearings] + [(f"floor '{name}'", tag) for name, tag in (floors or {}).items()]:
        model.require_free(what, tag)
    stiffness, masses = model.matrices()
    require_floating(model, stiffness)
    stiffness, masses, kept = condensed(model, stiffness, masses)
    rows = {model.dofs[old]: new for new, old in enumerate(kept, 1)}
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    write_matrix(folder / "k.mtx", stiffness, len(kept))
    write_matrix(folder / "m.mtx", {(i, i): mass for i, mass in enumerate(masses)}, len(kept))
    with open(folder / "nodes.csv", "w") as file:
        print("node,x_m,y_m,z_m,dof_x,dof_y,dof_z", file=file)
        for tag in ops.getNodeTags():
            own = [rows.get((tag, dof), 0) for dof in (1, 2, 3)]
            if any(own):
                print(tag, *(repr(x * length_unit_m) for x in ops.nodeCoord(tag)), *own, sep=",", file=file)
    (folder / "bearings.csv").write_text("node\n" + "".join(f"{tag}\n" for tag in bearings))
    (folder / "floors.csv").write_text("name,node\n" + "".join(f"{name},{tag}\n" for name, tag in (floors or {}).items()))
    return len(kept), len(model.dofs) - len(kept)


class Model:
    """The free degrees of freedom of a model, and its matrices [SI]."""

    def __init__(self, length, force):
        self.length, self.force = length, force
        self.constrained = {tag: set(ops.getConstrainedDOFs(tag)) for tag in ops.getConstrainedNodes()}
        self.retained = {tag: ops.getRetainedNodes(tag) for tag in self.constrained}
        self.fixed = {tag: set(ops.getFixedDOFs(tag)) for tag in ops.getFixedNodes()}
        self.sizes = {tag: ops.getNDF(tag)[0] for tag in ops.getNodeTags()}
        self.free = {tag: [dof for dof in range(1, size + 1)
                           if dof not in self.constrained.get(tag, ()) and dof not in self.fixed.get(tag, ())]
                     for tag, size in self.sizes.items()}
        self.dofs = [(tag, dof) for tag, free in self.free.items() for dof in free]
        self.at = {dof: i for i, dof in enumerate(self.dofs)}

    def require_free(self, what, tag):
        if tag not in self.free:
            raise ValueError(f"{what}: there is no node {tag}")
        for dof in (1, 2, 3):
            if dof in self.constrained.get(tag, ()):
                raise ValueError(f"{what}: node {tag} follows node {self.retained[tag][0]} along {DIRECTIONS[dof - 1]}, "
                                 "expected a node that moves freely")
            if dof not in self.free[tag]:
                raise ValueError(f"{what}: node {tag} is fixed along {DIRECTIONS[dof - 1]}, expected a node that moves freely")

    def matrices(self):
        """Stiffness as {(row, column): value}, and the diagonal of the mass."""
        stiffness, mass = {}, np.zeros(len(self.dofs))
        held = [(tag, dof) for tag, free in self.free.items() for dof in free]
        for tag, dof in held:
            self.fix(tag, [dof])
        for nodes in self.blocks():
            for tag in nodes:
                for dof in self.free[tag]:
                    ops.remove("sp", tag, dof)
            self.add_block(nodes, stiffness, mass)
            for tag in nodes:
                self.fix(tag, self.free[tag])
        for tag, dof in held:
            ops.remove("sp", tag, dof)
        ops.wipeAnalysis()
        return stiffness, mass

    def fix(self, tag, dofs):
        if dofs:
            ops.fix(tag, *(int(dof in dofs) for dof in range(1, self.sizes[tag] + 1)))

    def blocks(self):
        """Sets of nodes such that those of each element are together in one: halves along the longest side."""
        def nodes_of(elements):
            nodes = {tag for element in elements for tag in ops.eleNodes(element)}
            nodes |= {retained for tag in nodes for retained in self.retained.get(tag, ())}
            return [tag for tag in sorted(nodes) if self.free[tag]]

        def halves(elements):
            nodes = nodes_of(elements)
            if len(elements) < 2 or sum(len(self.free[tag]) for tag in nodes) <= BLOCK:
                return [nodes] if nodes else []
            centres = np.array([np.mean([ops.nodeCoord(tag) for tag in ops.eleNodes(element)], axis=0) for element in elements])
            order = np.argsort(centres[:, np.argmax(np.ptp(centres, axis=0))], kind="stable")
            sorted_elements = [elements[i] for i in order]
            middle = len(elements) // 2
            return halves(sorted_elements[:middle]) + halves(sorted_elements[middle:])

        found = halves(list(ops.getEleTags()))
        alone = set(self.free) - {tag for nodes in found for tag in nodes}
        loose = [tag for tag in sorted(alone) if self.free[tag]]
        if loose:
            raise ValueError(f"node {loose[0]} is free and has no element, expected it to be fixed or removed")
        return found

    def add_block(self, nodes, stiffness, mass):
        """Adds the rows and columns of a block, in which all other nodes are fixed."""
        ops.wipeAnalysis()
        ops.constraints("Transformation" if self.constrained else "Plain")  # Plain takes less time
        ops.numberer("Plain")
        ops.system("FullGeneral")
        ops.algorithm("Linear")
        ops.integrator("GimmeMCK", 0.0, 0.0, 1.0)
        ops.analysis("Transient")
        ops.analyze(1, 0.0)  # numbers the equations
        size = ops.systemSize()
        own = np.full(size, -1)
        for tag in nodes:
            # OpenSees lists a constrained node's own equations first, then those of the retained node.
            left = [dof for dof in range(1, self.sizes[tag] + 1) if dof not in self.constrained.get(tag, ())]
            for dof, equation in zip(left, ops.nodeDOFs(tag)):
                if equation >= 0:
                    own[equation] = self.at[tag, dof]
        if (own < 0).any():
            raise ValueError(f"{np.count_nonzero(own < 0)} equations of OpenSees belong to no node: its constraints are of a kind "
                             "that is not known here")
        scale = np.array([self.length if self.dofs[i][1] > 3 else 1.0 for i in own])  # of a rotation
        units = np.outer(scale, scale) * self.force / self.length
        block = np.array(ops.printA("-ret")).reshape(size, size) * units
        self.require_symmetric(block, own)
        for i, j in zip(*np.nonzero(np.tril(block))):
            row, column = max(own[i], own[j]), min(own[i], own[j])
            stiffness[row, column] = (block[i, j] + block[j, i]) / 2
        ops.integrator("GimmeMCK", 1.0, 0.0, 0.0)
        block = np.array(ops.printA("-ret")).reshape(size, size) * units
        self.require_diagonal(block, own)
        mass[own] = np.diag(block)

    def named(self, i):
        tag, dof = self.dofs[i]
        return f"degree of freedom {dof} of node {tag}"

    def require_symmetric(self, block, own):
        largest = np.maximum.outer(np.diag(block), np.diag(block))
        i, j = np.unravel_index(np.argmax(abs(block - block.T) - 1e-9 * largest), block.shape)
        if abs(block[i, j] - block[j, i]) > 1e-9 * largest[i, j]:
            raise ValueError(f"the stiffness is not symmetric: {self.named(own[i])} and {self.named(own[j])}")

    def require_diagonal(self, block, own):
        off = abs(block - np.diag(np.diag(block)))
        i, j = np.unravel_index(np.argmax(off), off.shape)
        if off[i, j] > 1e-12 * np.max(np.diag(block)):
            raise ValueError(f"the mass couples {self.named(own[i])} and {self.named(own[j])}, expected masses of nodes, and those "
                             "of a rigid diaphragm at its retained node")


def require_floating(model, stiffness):
    """A translation of the whole structure meets no force."""
    largest = max(value for (row, column), value in stiffness.items() if row == column)
    for direction in (1, 2, 3):
        force = np.zeros(len(model.dofs))
        for (row, column), value in stiffness.items():
            force[row] += value * (model.dofs[column][1] == direction)
            force[column] += value * (row != column and model.dofs[row][1] == direction)
        at = int(np.argmax(abs(force)))
        if abs(force[at]) > 1e-8 * largest:
            raise ValueError(f"a support holds the structure along {DIRECTIONS[direction - 1]} at {model.named(at)}: leave the "
                             "elements of the bearings out, by their tags in `without`")


def condensed(model, stiffness, mass):
    """Without the degrees of freedom that have no mass: stiffness, mass and the indices of the rest."""
    is_kept = mass > 0
    kept = np.flatnonzero(is_kept)
    new = np.cumsum(is_kept) - 1
    result = {(new[i], new[j]): value for (i, j), value in stiffness.items() if is_kept[i] and is_kept[j]}
    loose = np.flatnonzero(~is_kept)
    if len(loose) == 0:
        return result, mass[kept], kept
    if len(loose) > MOST_WITHOUT_MASS:
        raise ValueError(f"{len(loose)} degrees of freedom have no mass, expected at most {MOST_WITHOUT_MASS}; the first is "
                         f"{model.named(loose[0])}")
    place = np.cumsum(~is_kept) - 1
    inner, across = np.zeros((len(loose), len(loose))), np.zeros((len(loose), len(kept)))
    for (i, j), value in stiffness.items():
        if not is_kept[i] and not is_kept[j]:
            inner[place[i], place[j]] = inner[place[j], place[i]] = value
        elif is_kept[i] != is_kept[j]:
            i, j = (j, i) if is_kept[i] else (i, j)
            across[place[i], new[j]] = value
    beside = np.flatnonzero(across.any(axis=0))  # kept ones that are connected to any of them
    across = across[:, beside]
    change = across.T @ np.linalg.solve(inner, across)
    for a, i in enumerate(beside):
        for b, j in enumerate(beside[:a + 1]):
            result[i, j] = result.get((i, j), 0.0) - (change[a, b] + change[b, a]) / 2
    return result, mass[kept], kept


def write_matrix(file, entries, size):
    """The lower triangle, without rounding errors of zeros."""
    entries = {place: value for place, value in entries.items()
               if place[0] == place[1] or abs(value) > 1e-15 * (entries[place[0], place[0]] * entries[place[1], place[1]]) ** 0.5}
    with open(file, "w") as out:
        print("%%MatrixMarket matrix coordinate real symmetric", file=out)
        print(size, size, len(entries), file=out)
        for (row, column), value in sorted(entries.items(), key=lambda entry: (entry[0][1], entry[0][0])):
            print(row + 1, column + 1, repr(float(value)), file=out)
