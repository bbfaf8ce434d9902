"""Machines of which pictures are drawn in tests, a chute and a drum with lifters, and the folders of their runs."""

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import (
    SurfaceMesh,
    area_vectors,
    centroids,
    node_area_vectors,
    sum_over_nodes,
    unit_normals,
    write_surface,
)
from bulkwear.postproc.wear.area_patches import area_patches, patch_table
from bulkwear.postproc.wear.thickness import with_thickness


def box(size, edge, centre=(0.0, 0.0, 0.0), turned_deg=0.0):
    """A closed box with faces of about an edge, turned about y; size: (3,) m along x, y, z before."""
    size, points, triangles = np.array(size), [], []
    for axis in range(3):
        across = [k for k in range(3) if k != axis]
        counts = [max(round(size[k] / edge), 1) for k in across]
        u, v = np.meshgrid(
            *(np.linspace(-0.5, 0.5, count + 1) * size[k] for count, k in zip(counts, across, strict=True))
        )
        for side in (-0.5, 0.5):
            flat = np.zeros((u.size, 3))
            flat[:, across[0]], flat[:, across[1]], flat[:, axis] = u.ravel(), v.ravel(), side * size[axis]
            cells = _grid_triangles(counts[1], counts[0], sum(map(len, points)))
            outwards = area_vectors(np.concatenate([*points, flat]), cells[:1])[0, axis] * side > 0
            points.append(flat)
            triangles.append(cells if outwards else cells[:, ::-1])
    turn = np.radians(turned_deg)
    rotation = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
    return merged(np.concatenate(points) @ rotation.T + centre, np.concatenate(triangles))


def _grid_triangles(lines, columns, first=0):
    corner = (np.arange(lines)[:, None] * (columns + 1) + np.arange(columns)).ravel() + first
    lower = np.column_stack([corner, corner + 1, corner + columns + 2])
    return np.concatenate([lower, np.column_stack([corner, corner + columns + 2, corner + columns + 1])])


def merged(points, triangles):
    """A surface whose equal points are one."""
    _, first, inverse = np.unique(np.round(points, 9), axis=0, return_index=True, return_inverse=True)
    return SurfaceMesh(points[first], inverse.ravel()[triangles])


def without_lid(size, edge, centre):
    """A box that is open on top."""
    closed = box(size, edge, centre)
    top = (closed.points[closed.triangles][:, :, 2] > centre[2] + 0.5 * size[2] - 1e-9).all(axis=1)
    return SurfaceMesh(closed.points, closed.triangles[~top])


def drum(radius=1.0, width=0.3, lifters=8, height=0.1, edge=0.04, thickness=0.08, worn=0.0):
    """A ring about y with lifters inside, closed; worn: m that their tops have lost."""
    angle = np.linspace(
        0.0, 2.0 * np.pi, max(round(2.0 * np.pi * radius / edge / lifters), 4) * lifters, endpoint=False
    )
    phase = np.abs((angle * lifters / (2.0 * np.pi) + 0.5) % 1.0 - 0.5) * 2.0 * np.pi * radius / lifters
    inner = radius - (height - worn) * np.clip(1.8 - phase / (0.7 * height), 0.0, 1.0)
    across = np.linspace(-0.5, 0.5, max(round(width / edge), 1) + 1) * width
    rings = [(inner, y) for y in across] + [(np.full_like(angle, radius + thickness), y) for y in across[::-1]]
    points = np.concatenate(
        [np.column_stack([r * np.sin(angle), np.full_like(angle, y), r * np.cos(angle)]) for r, y in rings]
    )
    count, triangles = len(angle), []
    for ring in range(len(rings)):
        here, there = ring * count, ((ring + 1) % len(rings)) * count
        k, after = np.arange(count), (np.arange(count) + 1) % count
        triangles += [
            np.column_stack([here + k, there + k, there + after]),
            np.column_stack([here + k, there + after, here + after]),
        ]
    mesh = SurfaceMesh(points, np.concatenate(triangles))
    middle = centroids(mesh.points, mesh.triangles)
    inside = np.hypot(middle[:, 0], middle[:, 2]) < radius * 0.999
    inwards = np.einsum("ij,ij->i", area_vectors(mesh.points, mesh.triangles), -middle * [1, 0, 1])
    return mesh if inwards[inside].sum() > 0 else SurfaceMesh(mesh.points, mesh.triangles[:, ::-1])


def joined(parts):
    """One surface of parts [(mesh, label)], with the label of every face."""
    points, triangles, labels = [], [], []
    for mesh, label in parts:
        triangles.append(mesh.triangles + sum(map(len, points)))
        points.append(mesh.points)
        labels += [label] * len(mesh.triangles)
    return SurfaceMesh(np.concatenate(points), np.concatenate(triangles), {"part": np.array(labels)})


def chute(edge=0.05):
    """A chute as drawn: an upright impact plate, an inclined liner, a rigid side; {name: mesh}."""
    return {
        "impact_plate": box((0.03, 0.8, 1.0), edge, (0.9, 0.0, 1.6)),
        "liner": box((1.6, 0.8, 0.03), edge, (0.1, 0.0, 0.45), -35.0),
        "side": box((2.2, 0.01, 2.0), 0.4, (0.2, 0.42, 1.0)),
    }


def spot(mesh, centre, size, normal, height=1.0):
    """A value per face that falls off from a place as a bell, on faces that look along a normal; (m,)."""
    away = np.linalg.norm(centroids(mesh.points, mesh.triangles) - centre, axis=1)
    facing = unit_normals(mesh.points, mesh.triangles) @ normal > 0.5
    return height * np.where(facing, np.exp(-0.5 * (away / size) ** 2), 0.0)


# ---------------------------------------------------------------- folders of runs

PATCH, TIME_STEP, BLOCK = 0.3, 1e-3, 0.5  # m; s; s
REPORTS, PICTURES = 10, 2  # of a block
RATE, HELD, PARTICLE = 100.0, 50.0, 0.1  # kg/s, kg, kg
THICKNESS = 0.03  # m, of parts that wear
PHASES = ("start_up", "pristine", "pristine", "wearing", "wearing", "worn")
UPDATE_HOURS = 1000.0
TURN = {"kind": "rotation", "point_m": [0.0, 0.0, 0.0], "axis": [0.0, 1.0, 0.0], "speed_rad_per_s": 2.0}
CHUTE_PEAKS = {  # part: place (m), size (m), normal, mm per 1,000 h
    "impact_plate": ((0.885, 0.0, 1.5), 0.3, (-1.0, 0.0, 0.0), 2.0),
    "liner": ((0.3, 0.0, 0.61), 0.4, (-0.574, 0.0, 0.819), 1.0),
}


def chute_recession(name, mesh, factor=1.0):
    """Recession (m,) m/h of the faces of a part of the chute, 0 of what keeps its shape."""
    if name not in CHUTE_PEAKS:
        return np.zeros(len(mesh.triangles))
    place, size, normal, peak = CHUTE_PEAKS[name]
    return spot(mesh, np.array(place), size, np.array(normal), factor * peak * 1e-6)


def drum_recession(name, mesh, factor=1.0):
    """Recession (m,) m/h of a drum: its inside, lifters most."""
    middle, normal = centroids(mesh.points, mesh.triangles), unit_normals(mesh.points, mesh.triangles)
    distance = np.hypot(middle[:, 0], middle[:, 2])
    inwards = -np.einsum("ij,ij->i", normal, middle * [1, 0, 1]) / distance
    return factor * 1e-6 * np.where((inwards > 0.2) & (distance < 1.001), 0.5 + 2.0 * (distance < 0.96), 0.0)


def stream(time, count=150, seed=1):
    """Particles that fall and turn to +x, (n, 7): place, velocity, radius."""
    generator = np.random.default_rng([seed, round(1e3 * time)])
    along = generator.uniform(0.0, 1.0, count)
    place = np.column_stack([-0.3 + 1.1 * along, generator.normal(0.0, 0.1, count), 2.2 - 1.4 * along**2])
    velocity = np.column_stack([np.full(count, 1.1), np.zeros(count), -2.8 * along])
    return np.column_stack([place, velocity, np.full(count, 0.02)])


def mill_charge(time, count=3000, toe=130.0, shoulder=300.0, seed=1):
    """Particles that lie evenly in the segment of a drum of radius 1 m between toe and shoulder, turning with it."""
    generator = np.random.default_rng([seed, round(1e3 * time)])
    radius, angle = 0.97 * np.sqrt(generator.uniform(0.0, 1.0, 6 * count)), generator.uniform(0.0, 360.0, 6 * count)
    half = 0.5 * (shoulder - toe)
    deep = radius * np.cos(np.radians(angle - 0.5 * (toe + shoulder))) > np.cos(np.radians(half))
    radius, turn = radius[deep][:count], np.radians(angle[deep][:count])
    along = generator.uniform(-0.14, 0.14, len(turn))
    place = np.column_stack([radius * np.sin(turn), along, radius * np.cos(turn)])
    velocity = np.cross([0.0, 2.0, 0.0], place * [1, 0, 1])
    return np.column_stack([place, velocity, np.full(len(turn), 0.02)])


def write_machine(folder, run, meshes, recession, particles=stream, **told):
    """Write the folder of a run as the engine leaves it; return what jobs are told of it.

    meshes: {name: mesh}; recession: (name, mesh) -> (m,) m/h, parts without any keep their shape; particles: of a time
    told: besides what is always told
    """
    rates = {name: recession(name, mesh) for name, mesh in meshes.items()}
    labels = {name: k if rates[name].any() else -1 - k for k, name in enumerate(meshes)}
    whole = joined([(mesh, labels[name]) for name, mesh in meshes.items()])
    pristine = with_thickness(whole, {label: THICKNESS for label in labels.values() if label >= 0})
    patch, rate = area_patches(whole, PATCH), np.concatenate(list(rates.values()))
    size = np.linalg.norm(area_vectors(whole.points, whole.triangles), axis=1)
    area = np.bincount(patch[patch >= 0], size[patch >= 0])
    table = pd.DataFrame(patch_table(whole, patch))
    table["part"] = table["part"].map({label: name for name, label in labels.items()})
    table["thickness_m"] = THICKNESS
    table["recession_m_per_h"] = np.bincount(patch[patch >= 0], (size * rate)[patch >= 0]) / area
    each_update = told.pop("update_hours", UPDATE_HOURS)
    place, depth, rows = folder / run, np.zeros(len(whole.points)), []
    place.mkdir(parents=True)
    write_surface(place / "surface.vtu", whole)
    for cycle, phase in enumerate(PHASES):
        inside, hours = place / f"cycle_{cycle:03d}", each_update if phase == "wearing" else 0.0
        inside.mkdir()
        reached = each_update * PHASES[:cycle].count("wearing")
        head = {"cycle": cycle, "phase": phase, "operation_h": reached, "stands_for_h": hours, "duration_s": BLOCK}
        _write_flow(
            inside, cycle, told.get("rate_kg_per_s", RATE), [n for n in meshes if told.get("motion", {}).get(n)]
        )
        for picture in range(1, PICTURES + 1):
            step = round(BLOCK * (cycle + picture / PICTURES) / TIME_STEP)
            _write_picture(inside / f"picture_{step}.dump", step, particles(step * TIME_STEP))
        if cycle:
            _write_patches(inside, table, head, patch, size, depth[whole.triangles].mean(axis=1))
            _write_parts(inside, head, labels, whole, size * rate)
            depth = depth + hours * _at_nodes(whole, rate, size)
            write_surface(inside / "surface.vtu", _worn(pristine, depth))
            rows.append(head | {"time_s": BLOCK * (cycle + 1)})
    pd.DataFrame(rows).to_csv(place / "wear.csv", index=False)
    write_surface(place / "worn_surface.vtu", _worn(pristine, depth))
    return _told(run, labels, **told)


def _told(
    run, labels, setting="", packing=1, rate_kg_per_s=RATE, motion=None, operation=None, periodic=None, filling=None
):
    part = {"file": "part.step", "material": "steel", "density_kg_per_m3": 7900.0, "law": "archard"}
    part |= {"wear_coefficient_per_pa": 6e-13, "wear_coefficient_error": 0.1}
    return {
        **{"run": run, "row": run, "setting": setting or run, "packing": packing, "rate_kg_per_s": rate_kg_per_s},
        **{"block_s": BLOCK, "patch_m": PATCH, "time_step_s": TIME_STEP, "periodic": periodic, "filling": filling},
        "operation": operation or {"change_out_remaining_m": 0.01, "duration_s": 3600.0 * 6000.0},
        "parts": {
            name: part
            | {"wears": k >= 0, "thickness_m": THICKNESS if k >= 0 else None, "motion": (motion or {}).get(name)}
            for name, k in labels.items()
        },
    }


def _at_nodes(mesh, values, size):
    """The mean of values of faces at nodes, of those that have any."""
    worn = values > 0.0
    weight = sum_over_nodes(mesh.triangles[worn], size[worn], len(mesh.points))
    total = sum_over_nodes(mesh.triangles[worn], (size * values)[worn], len(mesh.points))
    return np.divide(total, weight, out=np.zeros(len(weight)), where=weight > 0.0)


def _worn(pristine, depth):
    """The surface whose nodes have gone inwards by a depth (n,) m."""
    normal = node_area_vectors(pristine.points, pristine.triangles)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    points = pristine.points - depth[:, None] * normal / np.maximum(length, 1e-30)
    fields = {"removed_thickness_m": depth, "lost_thickness_m": depth}
    return SurfaceMesh(points, pristine.triangles, pristine.cell_data, pristine.point_data | fields)


def _write_flow(inside, cycle, rate, moving):
    times = BLOCK * (cycle + np.arange(1, REPORTS + 1) / REPORTS)
    put = np.round((rate * times if rate else np.full(REPORTS, HELD)) / PARTICLE).astype(int)
    held = np.minimum(put, round(HELD / PARTICLE))
    counts = {"particles": held, "inserted_particles": put, "out_particles": put - held}
    masses = {
        "held_mass_kg": PARTICLE * held,
        "inserted_mass_kg": PARTICLE * put,
        "out_mass_kg": PARTICLE * (put - held),
    }
    powers = {f"power_{name}_W": 1500.0 for name in moving}
    pd.DataFrame({"time_s": times, **counts, **masses, "kinetic_energy_J": 10.0, **powers}).to_csv(
        inside / "flow.csv", index=False
    )


def _write_picture(path, step, particles):
    spins = np.zeros((len(particles), 3))
    rows = np.column_stack([np.arange(1, len(particles) + 1), particles[:, :6], spins, particles[:, 6]])
    head = ["ITEM: TIMESTEP", f"{step}", "ITEM: NUMBER OF ATOMS", f"{len(rows)}", "ITEM: BOX BOUNDS ff ff ff"]
    head += [*["-9 9"] * 3, "ITEM: ATOMS id x y z vx vy vz omegax omegay omegaz radius"]
    lines = [f"{row[0]:.0f} " + " ".join(f"{value:.6g}" for value in row[1:]) for row in rows]
    path.write_text("\n".join([*head, *lines]) + "\n")


def _write_patches(inside, table, head, patch, size, depth):
    there = patch >= 0
    depths = np.bincount(patch[there], (size * depth)[there]) / np.bincount(patch[there], size[there])
    rate = table["recession_m_per_h"]
    loads = {"pressure_Pa": 1e9 * rate, "sliding_velocity_m_per_s": np.where(rate > 0.0, 2.0, 0.0)}
    loads |= {"sliding_power_W_per_m2": 2e9 * rate, "impact_power_W_per_m2": 1e8 * rate}
    table.assign(**head, depth_m=depths, back_recession_m_per_h=0.0, **loads).to_csv(
        inside / "patches.csv", index=False
    )


def _write_parts(inside, head, labels, mesh, volume):
    rows = []
    for name, label in labels.items():
        own = float(volume[mesh.cell_data["part"] == label].sum())
        loads = {f"{kind}_{axis}_{unit}": 1.0 for kind, unit in (("force", "N"), ("torque", "N_m")) for axis in "xyz"}
        rows.append(
            head
            | {"part": name, "role": "wears" if label >= 0 else "rigid", **loads, "power_W": 0.0}
            | {"worn_volume_m3_per_h": own, "worn_mass_kg_per_h": 7900.0 * own}
            | {"sliding_power_W": 1.0, "impact_power_W": 1.0}
        )
    pd.DataFrame(rows).to_csv(inside / "parts.csv", index=False)


REMARKS = ["particles at scale 5: 50 mm for 10 mm", "wear accelerated 10000 times", "made for tests"]


def chute_study(folder):
    """Two designs of the chute, two packings each; the second wears half as fast and is worn for longer."""
    meshes, found = chute(0.12), []
    for setting, factor in (("plain", 1.0), ("convex", 0.5)):
        for packing in (1, 2):
            own = factor * (0.9 if packing == 1 else 1.1)
            name = setting if packing == 1 else f"{setting}-{packing}"
            rates = {each: chute_recession(each, mesh, own) for each, mesh in meshes.items()}
            told = {
                "setting": setting,
                "packing": packing,
                "update_hours": UPDATE_HOURS * (1.0 if factor == 1.0 else 1.6),
            }
            found.append(write_machine(folder, name, meshes, lambda each, _, rates=rates: rates[each], **told))
    return found


def drum_study(folder):
    """A mill of one design and packing; what jobs are told."""
    told = {"motion": {"shell": TURN}, "rate_kg_per_s": None}
    told |= {"periodic": {"axis": "y", "low_m": -0.15, "high_m": 0.15}}
    told |= {"filling": {"fraction": 0.3, "axis": "y", "radius_m": 0.95, "length_m": 0.3}}
    return [write_machine(folder, "A", {"shell": drum(edge=0.08)}, drum_recession, mill_charge, **told)]


def job_of_study(folder, runs):
    """A job of any figure of a study whose tables are made: files by the names that figures use."""
    from bulkwear.workflows.cases.equipment.figures import TABLES
    from bulkwear.workflows.report.products import job_of

    files = {name: str(folder / path) for name, path in TABLES.items()}
    names = {"wear": "wear.csv", "surfaces": "surface.vtu", "worn": "worn_surface.vtu"}
    files |= {name: [str(folder / run["run"] / file) for run in runs] for name, file in names.items()}
    return job_of(files, {"runs": runs}, REMARKS)


def write_tables(folder, runs):
    """Make those tables of a study that figures are drawn of, as its job does."""
    from bulkwear.workflows.cases.equipment.figures import TABLES
    from bulkwear.workflows.cases.equipment.life import part_lives
    from bulkwear.workflows.cases.equipment.life_tables import life_table, worst_places
    from bulkwear.workflows.cases.equipment.tables import rates_table, read_runs

    found = read_runs(runs, folder)
    lives, rates = part_lives(found, {}), rates_table(found)
    made = {"rates": rates, "life": life_table(found, lives), "worst_places": worst_places(found, rates, lives)}
    for name, table in made.items():
        path = folder / TABLES[name]
        path.parent.mkdir(exist_ok=True)
        table.to_csv(path, index=False)
    return made


# ---------------------------------------------------------------- what a figure must be


def faults_of(figure):
    """What a reader would stumble over: text too small, outside the picture or over other text, no remarks."""
    from bulkwear.postproc.plots.style import SMALLEST_FONT, remarks_of

    figure.draw_without_rendering()  # places all text
    texts, canvas, found = seen_texts(figure), figure.bbox, []
    boxes = [(text, text.get_window_extent()) for text in texts]
    found = [f"small: {text.get_text()}" for text in texts if text.get_fontsize() < SMALLEST_FONT]
    room = 2.0  # pixels: letters are a little narrower than their boxes
    for k, (text, box) in enumerate(boxes):
        if min(box.x0, box.y0) < -room or box.x1 > canvas.x1 + room or box.y1 > canvas.y1 + room:
            found.append(f"outside: {text.get_text()}")
        for other, beside in boxes[k + 1 :]:
            wide, high = (
                min(box.x1, beside.x1) - max(box.x0, beside.x0),
                min(box.y1, beside.y1) - max(box.y0, beside.y0),
            )
            if wide > room and high > room:
                found.append(f"over each other: {text.get_text()} | {other.get_text()}")
    return found + [f"missing: {word}" for word in REMARKS if word not in remarks_of(figure)]


def seen_texts(figure):
    """All text that a figure shows: of ticks only that of those inside their axis."""
    texts = figure.findobj(lambda each: hasattr(each, "get_fontsize"))
    hidden, axes_of = set(), figure.findobj(lambda each: hasattr(each, "xaxis") and hasattr(each, "yaxis"))
    for axes in axes_of:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()):
                if not (axes.axison and low - 1e-9 <= tick.get_loc() <= high + 1e-9):
                    hidden |= {tick.label1, tick.label2}
            if not axes.axison:
                hidden |= {axis.label, axis.offsetText}
    return [text for text in texts if text not in hidden and text.get_visible() and text.get_text().strip()]
