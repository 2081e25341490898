# SPDX-License-Identifier: MIT
"""3MF files as slicers write them, of bodies of a few triangles."""

import zipfile

import numpy as np

MODEL = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
THUMBNAIL = "http://schemas.openxmlformats.org/package/2006/relationships/metadata/thumbnail"
TYPES = ("http://schemas.openxmlformats.org/package/2006/content-types",
         {"rels": "application/vnd.openxmlformats-package.relationships+xml",
          "model": "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"})
DECLARED = '<?xml version="1.0" encoding="UTF-8"?>\n'


def mesh_text(triangles):
    """The mesh of triangles (n, corner, axis) in the words of 3MF."""
    points, numbers = np.unique(np.reshape(triangles, (-1, 3)), axis=0, return_inverse=True)
    vertices = "".join('<vertex x="{:.9g}" y="{:.9g}" z="{:.9g}"/>'.format(*point) for point in points)
    faces = "".join('<triangle v1="{}" v2="{}" v3="{}"/>'.format(*face) for face in numbers.reshape(-1, 3))
    return f"<mesh><vertices>{vertices}</vertices><triangles>{faces}</triangles></mesh>"


def write_three_mf(path, resources, items, files=None, relations=()):
    """`files`: further ones by name; `relations`: targets and types, of files that are there or not."""
    of_package = [("/3D/3dmodel.model", MODEL), *relations]
    related = "".join(f'<Relationship Target="{target}" Id="r{number}" Type="{kind}"/>'
                      for number, (target, kind) in enumerate(of_package))
    types = "".join(f'<Default Extension="{ending}" ContentType="{kind}"/>' for ending, kind in TYPES[1].items())
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("[Content_Types].xml", f'{DECLARED}<Types xmlns="{TYPES[0]}">{types}</Types>')
        archive.writestr("_rels/.rels", f'{DECLARED}<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/'
                                        f'relationships">{related}</Relationships>')
        archive.writestr("3D/3dmodel.model", f'{DECLARED}<model unit="millimeter" xmlns="http://schemas.microsoft.com/'
                                             f'3dmanufacturing/core/2015/02"><resources>{resources}</resources>'
                                             f'<build>{items}</build></model>')
        for name, content in (files or {}).items():
            archive.writestr(name, content)


def write_prusa_slicer(path, *volumes):
    """A file as PrusaSlicer's command line leaves it. `volumes`: their types and triangles."""
    ranges, first = "", 0
    for kind, triangles in volumes:
        ranges += (f'<volume firstid="{first}" lastid="{first + len(triangles) - 1}">'
                   f'<metadata type="volume" key="volume_type" value="{kind}"/></volume>')
        first += len(triangles)
    mesh = mesh_text(np.concatenate([triangles for _, triangles in volumes]))
    write_three_mf(path, f'<object id="1" type="model">{mesh}</object>', '<item objectid="1" printable="1"/>',
                   {"Metadata/Slic3r_PE_model.config": f'{DECLARED}<config><object id="1">{ranges}</object></config>'},
                   [("/Metadata/thumbnail.png", THUMBNAIL)])
