#!/usr/bin/env python3
"""Prints what trajectory_error_test.cc expects of two trajectories of 60 poses, worked out anew.

Written from evo's definitions (github.com/MichaelGrupp/evo, core/metrics.py, filters.py) with the
standard library alone: rotations are unit quaternions, alignment is Horn's (1987), by quaternions
too, where the library has matrices and Umeyama's singular values.
"""
import math


def qmul(a, b):
    w, x, y, z = a
    s, t, u, v = b
    return (w * s - x * t - y * u - z * v, w * t + x * s + y * v - z * u,
            w * u - x * v + y * s + z * t, w * v + x * u - y * t + z * s)


def conj(q):
    return (q[0], -q[1], -q[2], -q[3])


def rotate(q, p):
    return qmul(qmul(q, (0, *p)), conj(q))[1:]


def from_vector(v):
    angle = math.sqrt(sum(c * c for c in v))
    k = math.sin(angle / 2) / angle if angle else 0
    return (math.cos(angle / 2), *(k * c for c in v))


def relative(a, b):  # a^-1 b
    back = conj(a[0])
    return (qmul(back, b[0]), rotate(back, [y - x for x, y in zip(a[1], b[1])]))


def norm(v):
    return math.sqrt(sum(c * c for c in v))


def angle(q):
    return 2 * math.atan2(norm(q[1:]), abs(q[0]))


def measure(e, relation):
    turned = 2 * math.sqrt(2) * math.sin(angle(e[0]) / 2)  # |R - I|
    return {'translation': norm(e[1]), 'rotation': turned, 'angle': angle(e[0]),
            'full': math.hypot(turned, norm(e[1]))}[relation]


def reference(i):
    return (from_vector((0.02 * math.sin(0.2 * i), 0.01 * i, 0.05 * math.cos(0.1 * i))),
            (30 * math.cos(0.05 * i), 20 * math.sin(0.05 * i), 0.5 * math.sin(0.3 * i)))


def estimate(i):
    q, t = reference(i)
    noise = from_vector((0.01 * math.sin(1.3 * i), 0.02 * math.cos(0.7 * i), 0.015 * math.sin(2.1 * i)))
    off = (0.4 * math.sin(0.9 * i), 0.3 * math.cos(1.7 * i), 0.2 * math.sin(0.4 * i) + 0.004 * i)
    return (qmul(q, noise), tuple(a + b for a, b in zip(t, off)))


def statistics(errors):
    errors = sorted(errors)
    n = len(errors)
    mean = math.fsum(errors) / n
    sse = math.fsum(e * e for e in errors)
    median = errors[n // 2] if n % 2 else (errors[n // 2 - 1] + errors[n // 2]) / 2
    std = math.sqrt(math.fsum((e - mean) ** 2 for e in errors) / n)
    return (math.sqrt(sse / n), mean, median, std, errors[0], errors[-1], sse)


def pairs_by_path(poses, delta, all_pairs, tolerance):
    steps = [norm([y - x for x, y in zip(a[1], b[1])]) for a, b in zip(poses, poses[1:])]
    if not all_pairs:
        ids, path = [], 0
        for i, step in enumerate(steps, start=1):
            path += step
            if path >= delta:
                ids.append(i)
                path = 0
        return list(zip(ids, ids[1:]))
    along = [0]
    for step in steps:
        along.append(along[-1] + step)
    pairs = []
    for i in range(len(along) - 1):
        j = min(range(i + 1, len(along)), key=lambda k: abs(along[k] - along[i] - delta))
        if abs(along[j] - along[i] - delta) <= tolerance * delta:
            pairs.append((i, j))
    return pairs


def horn(source, target):
    """The rotation, and means, that bring source onto target."""
    mean = lambda points: [math.fsum(p[k] for p in points) / len(points) for k in range(3)]
    a, b = mean(source), mean(target)
    s = [[math.fsum((p[i] - a[i]) * (q[j] - b[j]) for p, q in zip(source, target))
          for j in range(3)] for i in range(3)]
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = s
    n = [[xx + yy + zz, yz - zy, zx - xz, xy - yx], [yz - zy, xx - yy - zz, xy + yx, zx + xz],
         [zx - xz, xy + yx, yy - xx - zz, yz + zy], [xy - yx, zx + xz, yz + zy, zz - xx - yy]]
    shift = math.sqrt(sum(c * c for row in n for c in row))  # makes the wanted eigenvalue largest
    q = [1.0, 0.1, 0.1, 0.1]
    for _ in range(20000):  # power iteration
        q = [sum(row[k] * q[k] for k in range(4)) + shift * q[i] for i, row in enumerate(n)]
        length = norm(q)
        q = [c / length for c in q]
    turned = [rotate(q, [c - m for c, m in zip(p, a)]) for p in source]
    centred = [[c - m for c, m in zip(p, b)] for p in target]
    scale = (math.fsum(x * y for p, r in zip(turned, centred) for x, y in zip(p, r)) /
             math.fsum(x * x for p in turned for x in p))
    rmse = lambda k: math.sqrt(math.fsum((k * x - y) ** 2 for p, r in zip(turned, centred)
                                         for x, y in zip(p, r)) / len(source))
    return scale, rmse(1), rmse(scale)


def show(name, values):
    print(f'{name}: ' + ', '.join(repr(float(v)) for v in values))


ref, est = [reference(i) for i in range(60)], [estimate(i) for i in range(60)]
for kind in ('translation', 'rotation', 'angle', 'full'):
    show('absolute ' + kind, statistics([measure(relative(e, r), kind) for r, e in zip(ref, est)]))


def relative_errors(name, pairs, kind):
    errors = [measure(relative(relative(ref[i], ref[j]), relative(est[i], est[j])), kind)
              for i, j in pairs]
    show(f'relative {name} {kind} ({len(errors)})', statistics(errors))


relative_errors('1 frame', [(i, i + 1) for i in range(59)], 'translation')
relative_errors('7 frames', [(i, i + 7) for i in range(0, 53, 7)], 'full')
relative_errors('7 frames, all pairs', [(i, i + 7) for i in range(53)], 'angle')
relative_errors('5 m', pairs_by_path(est, 5, False, 0.1), 'translation')
relative_errors('5 m, all pairs', pairs_by_path(est, 5, True, 0.1), 'translation')
relative_errors('5 m, all pairs of the reference', pairs_by_path(ref, 5, True, 0.1), 'rotation')
show('aligned: scale, rmse rigid, rmse with scale', horn([e[1] for e in est], [r[1] for r in ref]))
