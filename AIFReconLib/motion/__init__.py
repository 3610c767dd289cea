"""How the patient moved during a scan, found from the bone echoes of its passes and taken out of the poses.

May import bone/, effective_settings, sweep/, recipe/ and geometry/.
"""
