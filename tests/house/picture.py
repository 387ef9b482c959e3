"""The folders of the product in layers, and the arrows between them, as SVG."""
import html
from dataclasses import dataclass, field

SIDES = {  # fill, line, and the folders of each side
    "knows the ring, no structure": ("#dcebfa", "#3b78b5", ("memmap", "broker")),
    "knows structures, no ring": ("#e0f2e0", "#3f8f4f", ("maths", "controller", "sim", "diagnosis", "commissioning")),
    "both meet": ("#fdebd0", "#c27c1a", ("adapters", "experiment", "launch", "foreign")),
    "a test as a whole": ("#eeeeee", "#777777", ()),
}
LETTER, SMALL, LINE = 10, 7, 15  # width of a letter of a name and of a part, height of a line of parts [px]
GAP, LAYER_GAP, MARGIN, BEND = 26, 54, 24, 14
SWEEPS = 40


# --- the graph ----------------------------------------------------------------------------------------

def top_of(folder):
    return folder.split("/")[0]


def box_name(house, target):
    """The folder at the top, or the place that a target has of its own."""
    return house.plan["places"].get(target.name) or top_of(target.folder)


def graph_of(house):
    """Folders with their parts and layer, and arrows between folders that no other arrows imply."""
    forbidden, parts = {}, {}
    for target in house.product_targets:
        user = box_name(house, target)
        parts.setdefault(user, set()).update(target.folder.split("/")[1:2])
        for name in target.names:
            used = house.targets.get(name)
            if used and used.folder and box_name(house, used) != user:
                parts.setdefault(box_name(house, used), set())
                arrow = (user, box_name(house, used))
                is_wrong = not house.is_allowed(house.arrow(target, used))
                forbidden[arrow] = forbidden.get(arrow, True) and is_wrong
    below = {folder: sorted(used for user, used in forbidden if user == folder) for folder in parts}
    layers = layers_of(below)
    for folder in set(parts) - {box_name(house, target) for target in house.product_targets}:
        layers[folder] = min(layers[user] for user, used in forbidden if used == folder) - 1  # its own arrows are not drawn
    arrows = [{"from": user, "to": used, "forbidden": forbidden[user, used]}
              for user, used in sorted(forbidden) if not is_implied(user, used, below)]
    return {"folders": [{"name": folder, "parts": sorted(parts[folder]), "layer": layers[folder]} for folder in sorted(parts)],
            "arrows": arrows}


def layers_of(below):
    """The layer of each folder: one above the highest that it uses."""
    layers = {}

    def layer(folder, above):
        if folder in above:
            raise SystemExit(f"folders use each other: {' -> '.join([*above, folder])}")
        if folder not in layers:
            layers[folder] = 1 + max((layer(used, [*above, folder]) for used in below[folder]), default=-1)
        return layers[folder]

    for folder in below:
        layer(folder, [])
    return layers


def is_implied(user, used, below):
    """True if the user reaches the used folder by way of another."""
    seen, waiting = set(), [folder for folder in below[user] if folder != used]
    while waiting:
        folder = waiting.pop()
        if folder == used:
            return True
        if folder not in seen:
            seen.add(folder)
            waiting += below[folder]
    return False


# --- the layout ---------------------------------------------------------------------------------------

@dataclass
class Box:
    """A folder in its layer, or the place where a long arrow passes a layer."""
    name: str
    layer: int
    rows: list = field(default_factory=list)
    width: float = 8
    x: float = 0  # its middle
    above: list = field(default_factory=list)
    below: list = field(default_factory=list)

    @property
    def height(self):
        return 30 + LINE * len(self.rows)


def rows_of(parts, most=34):
    rows = []
    for part in parts:
        if rows and len(rows[-1]) + len(part) + 2 <= most:
            rows[-1] += ", " + part
        else:
            rows.append(part)
    return rows


def box_of(folder):
    rows = rows_of(folder["parts"])
    width = 28 + max([(LETTER + 1) * len(folder["name"])] + [SMALL * len(row) for row in rows])
    return Box(folder["name"], folder["layer"], rows, width)


def paths_of(boxes, arrows):
    """Each arrow as the boxes that it runs through, from top to bottom; adds the places where it passes layers."""
    paths = []
    for arrow in arrows:
        path = [boxes[arrow["from"]]]
        for layer in range(path[0].layer - 1, boxes[arrow["to"]].layer, -1):
            path.append(Box("", layer))
        path.append(boxes[arrow["to"]])
        for upper, lower in zip(path, path[1:]):
            upper.below.append(lower)
            lower.above.append(upper)
        paths.append((path, arrow["forbidden"]))
    return paths


def in_layers(boxes, paths):
    everything = {id(box): box for box in boxes.values()}
    for path, _ in paths:
        everything.update((id(box), box) for box in path)
    layers = [[] for _ in range(1 + max(box.layer for box in everything.values()))]
    for box in everything.values():
        layers[box.layer].append(box)
    return layers


def middle(values, otherwise):
    values = sorted(values)
    return sum(values) / len(values) if values else otherwise


def order(layers):
    """Orders each layer by the middle of its neighbours, downwards and upwards in turn; keeps the order with fewest crossings."""
    best, fewest = [list(layer) for layer in layers], crossings(layers)
    for sweep in range(SWEEPS):
        downwards = sweep % 2 == 0
        for layer in reversed(layers) if downwards else layers:
            place = {id(box): index for row in layers for index, box in enumerate(row)}
            layer.sort(key=lambda box: middle([place[id(each)] for each in (box.above if downwards else box.below)], place[id(box)]))
        if crossings(layers) < fewest:
            best, fewest = [list(layer) for layer in layers], crossings(layers)
    return best


def crossings(layers):
    place = {id(box): index for layer in layers for index, box in enumerate(layer)}
    count = 0
    for layer in layers:
        ends = [(place[id(box)], place[id(used)]) for box in layer for used in box.below]
        count += sum((a - c) * (b - d) < 0 for i, (a, b) in enumerate(ends) for c, d in ends[i + 1:])
    return count


def spread(layer, wanted):
    """Places of the boxes of a layer, in their order and without overlap, as far left as wanted."""
    places, left = [], None
    for box, place in zip(layer, wanted):
        if left is not None:
            place = max(place, left + GAP + box.width / 2)
        places.append(place)
        left = place + box.width / 2
    return places


def place(layers):
    """Pulls each box to the middle of its neighbours: the mean of the solutions from the left and from the right."""
    for layer in layers:
        for box, x in zip(layer, spread(layer, [0] * len(layer))):
            box.x = x
    for _ in range(SWEEPS * 2):
        for layer in layers:
            wanted = [middle([each.x for each in box.above + box.below], box.x) for box in layer]
            from_right = [-x for x in spread(layer[::-1], [-x for x in wanted[::-1]])][::-1]
            for box, low, high in zip(layer, spread(layer, wanted), from_right):
                box.x = (low + high) / 2
    least = min(box.x - box.width / 2 for layer in layers for box in layer)
    for layer in layers:
        for box in layer:
            box.x += MARGIN - least


# --- the drawing --------------------------------------------------------------------------------------

def side_of(folder):
    return next((side for side, (_, _, folders) in SIDES.items() if folder in folders), "a test as a whole")


def curve(points):
    """Vertical lines through the points of each layer, joined by curves."""
    text = f"M{points[0][0]:.1f},{points[0][1]:.1f}"
    for (x, y), (to_x, to_y) in zip(points, points[1:]):
        half = (to_y - y) / 2
        text += f" C{x:.1f},{y + half:.1f} {to_x:.1f},{to_y - half:.1f} {to_x:.1f},{to_y:.1f}"
    return text


def along(box, others, other):
    """Where an arrow meets a box: arrows of a side are spread over a part of its width."""
    ordered = sorted(others, key=lambda each: each.x)
    at = next(index for index, each in enumerate(ordered) if each is other)
    return box.x + (at - (len(ordered) - 1) / 2) * min(BEND, 0.7 * box.width / len(ordered))


def arrow_svg(path, is_forbidden, tops, bottoms):
    points = []
    for upper, lower in zip(path, path[1:]):
        points.append((along(upper, upper.below, lower), tops[upper.layer] + upper.height if upper.name else bottoms[upper.layer]))
        points.append((along(lower, lower.above, upper), tops[lower.layer]))
    style = 'stroke="#c03030" stroke-dasharray="6 4"' if is_forbidden else 'stroke="#666666"'
    mark = "wrong" if is_forbidden else "head"
    return f'<path d="{curve(points)}" fill="none" {style} stroke-width="1.4" marker-end="url(#{mark})"/>'


def box_svg(box, top):
    fill, line, _ = SIDES[side_of(box.name)]
    parts = [f'<rect x="{box.x - box.width / 2:.1f}" y="{top}" width="{box.width:.1f}" height="{box.height}" rx="5" '
             f'fill="{fill}" stroke="{line}"/>',
             f'<text x="{box.x:.1f}" y="{top + 20}" class="name">{html.escape(box.name)}</text>']
    for index, row in enumerate(box.rows):
        parts.append(f'<text x="{box.x:.1f}" y="{top + 36 + LINE * index}" class="part">{html.escape(row)}</text>')
    return "\n".join(parts)


def legend(top):
    parts, x = [], MARGIN
    for side, (fill, line, _) in SIDES.items():
        parts.append(f'<rect x="{x}" y="{top}" width="16" height="12" fill="{fill}" stroke="{line}"/>'
                     f'<text x="{x + 22}" y="{top + 10}" class="note">{side}</text>')
        x += 40 + SMALL * len(side)
    return "\n".join(parts)


HEAD = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}" height="{height:.0f}">
<style>text {{ font-family: Helvetica, Arial, sans-serif; }} .name {{ font-size: 15px; font-weight: bold; text-anchor: middle; }}
.part {{ font-size: 12px; fill: #444; text-anchor: middle; }} .note {{ font-size: 12px; fill: #444; }}</style>
<defs><marker id="head" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto"><path d="M0,0 L8,4 L0,8 z" fill="#666666"/></marker>
<marker id="wrong" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto"><path d="M0,0 L8,4 L0,8 z" fill="#c03030"/></marker></defs>
<rect width="100%" height="100%" fill="white"/>"""


def draw(graph):
    """The picture. Arrows that others imply are left out; a dashed red one is not in the plan."""
    boxes = {folder["name"]: box_of(folder) for folder in graph["folders"]}
    paths = paths_of(boxes, graph["arrows"])
    layers = order(in_layers(boxes, paths))
    place(layers)
    tops, bottoms, top = {}, {}, MARGIN
    for layer in range(len(layers) - 1, -1, -1):
        tops[layer] = top
        bottoms[layer] = top + max(box.height for box in layers[layer] if box.name)
        top = bottoms[layer] + LAYER_GAP
    width = max(box.x + box.width / 2 for layer in layers for box in layer) + MARGIN
    lines = [HEAD.format(width=max(width, 740), height=top + 6)]
    lines += [arrow_svg(path, is_forbidden, tops, bottoms) for path, is_forbidden in paths]
    lines += [box_svg(box, tops[box.layer]) for layer in layers for box in layer if box.name]
    return "\n".join([*lines, legend(top - 24), "</svg>"]) + "\n"
