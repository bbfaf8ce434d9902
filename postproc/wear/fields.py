"""Names of the fields that a worn surface carries from update to update, point data of its mesh.

They stand by themselves: tables and figures read fields without what makes them, which is slow to import.
"""

REMOVED_THICKNESS = "removed_thickness_m"
HEIGHT_LOSS = "height_loss_m"
RAY_DEPTH = "ray_depth_m"
NORMAL_DEPTH = "normal_depth_m"
FREE_RIM = "free_rim"  # 1 at the nodes of `update.free_rim`
CARRIED_VOLUME = "carried_volume_m3"
