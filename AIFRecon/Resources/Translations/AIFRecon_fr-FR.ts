<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="fr_FR" sourcelanguage="en_US">
<context>
    <name>AIFRecon</name>
    <message>
        <source>And also:</source>
        <translation>Et aussi :</translation>
    </message>
    <message>
        <source>Bone:</source>
        <translation>Os :</translation>
    </message>
    <message>
        <source>CT:</source>
        <translation>TDM :</translation>
    </message>
    <message>
        <source>Connection</source>
        <translation>Connexion</translation>
    </message>
    <message>
        <source>Live</source>
        <translation>En direct</translation>
    </message>
    <message>
        <source>More</source>
        <translation>Plus</translation>
    </message>
    <message>
        <source>None</source>
        <translation>Aucun</translation>
    </message>
    <message>
        <source>None (plain average)</source>
        <translation>Aucun (simple moyenne)</translation>
    </message>
    <message>
        <source>None yet</source>
        <translation>Aucun pour l'instant</translation>
    </message>
    <message>
        <source>Open recording, CT, segmentation...</source>
        <translation>Ouvrir enregistrement, TDM, segmentation...</translation>
    </message>
    <message>
        <source>Pause</source>
        <translation>Pause</translation>
    </message>
    <message>
        <source>Place CT on sweep</source>
        <translation>Placer la TDM sur le balayage</translation>
    </message>
    <message>
        <source>Reconstruct</source>
        <translation>Reconstruire</translation>
    </message>
    <message>
        <source>Record</source>
        <translation>Enregistrer</translation>
    </message>
    <message>
        <source>Recorded</source>
        <translation>Enregistré</translation>
    </message>
    <message>
        <source>Say where to move next</source>
        <translation>Dire où aller ensuite</translation>
    </message>
    <message>
        <source>Settings</source>
        <translation>Réglages</translation>
    </message>
    <message>
        <source>Start</source>
        <translation>Démarrer</translation>
    </message>
    <message>
        <source>Start over...</source>
        <translation>Recommencer...</translation>
    </message>
    <message>
        <source>Stop</source>
        <translation>Arrêter</translation>
    </message>
    <message>
        <source>Sweep and CT</source>
        <translation>Balayage et TDM</translation>
    </message>
    <message>
        <source>Sweep:</source>
        <translation>Balayage :</translation>
    </message>
    <message>
        <source>Try it on a sample patient</source>
        <translation>Essayer sur un patient fictif</translation>
    </message>
    <message>
        <source>Use the scanned box</source>
        <translation>Prendre la boîte balayée</translation>
    </message>
    <message>
        <source>Vertebrae:</source>
        <translation>Vertèbres :</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>pas démarré</translation>
    </message>
</context>
<context>
    <name>AIFReconLib</name>
    <message>
        <source>CT agrees: {found}</source>
        <translation>La TDM concorde : {found}</translation>
    </message>
    <message>
        <source>CT does not agree: {found}</source>
        <translation>La TDM ne concorde pas : {found}</translation>
    </message>
    <message>
        <source>Move the probe more slowly: {fast:.0f} mm/s at most.</source>
        <translation>Déplacez la sonde plus lentement : {fast:.0f} mm/s au plus.</translation>
    </message>
    <message>
        <source>Place the CT on the sweep before you believe the picture.</source>
        <translation>Placez la TDM sur le balayage avant de croire l'image.</translation>
    </message>
    <message>
        <source>Scan {name} again, from other angles.</source>
        <translation>Balayez encore {name}, sous d'autres angles.</translation>
    </message>
    <message>
        <source>no sweep yet</source>
        <translation>pas encore de balayage</translation>
    </message>
    <message>
        <source>told after the reconstruction</source>
        <translation>connu après la reconstruction</translation>
    </message>
    <message>
        <source>{frames}, {speed:.0f} mm/s</source>
        <translation>{frames}, {speed:.0f} mm/s</translation>
    </message>
    <message>
        <source>{share:.0%} of the echoes, {median:.1f} mm</source>
        <translation>{share:.0%} des échos, {median:.1f} mm</translation>
    </message>
    <message>
        <source>{used} of {frames} frames</source>
        <translation>{used} images sur {frames}</translation>
    </message>
</context>
<context>
    <name>inputs.readiness</name>
    <message>
        <source>Select a tracked sweep, or load a recording.</source>
        <translation>Choisissez un balayage ou chargez un enregistrement.</translation>
    </message>
    <message>
        <source>Without bone the sweep is averaged: nothing says at which angle a beam meets it.</source>
        <translation>Sans os, le balayage est moyenné : rien ne dit sous quel angle un faisceau le rencontre.</translation>
    </message>
</context>
<context>
    <name>panel.lights</name>
    <message>
        <source>Coverage</source>
        <translation>Couverture</translation>
    </message>
    <message>
        <source>Registration</source>
        <translation>Recalage</translation>
    </message>
    <message>
        <source>Tracking</source>
        <translation>Suivi</translation>
    </message>
    <message>
        <source>being looked at ...</source>
        <translation>examen en cours...</translation>
    </message>
</context>
<context>
    <name>panel.livePanel</name>
    <message>
        <source>Bring the probe into the tracker's view</source>
        <translation>Mettez la sonde dans le champ du traqueur</translation>
    </message>
    <message>
        <source>Press Start</source>
        <translation>Appuyez sur Démarrer</translation>
    </message>
    <message>
        <source>Scan on</source>
        <translation>Continuez à balayer</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>pas démarré</translation>
    </message>
    <message>
        <source>stopped</source>
        <translation>arrêté</translation>
    </message>
</context>
<context>
    <name>panel.recordedPanel</name>
    <message>
        <source>Done.</source>
        <translation>Terminé.</translation>
    </message>
    <message>
        <source>Sweep and CT</source>
        <translation>Balayage et TDM</translation>
    </message>
    <message>
        <source>Sweep and CT: {names}</source>
        <translation>Balayage et TDM : {names}</translation>
    </message>
</context>
<context>
    <name>panel.signals</name>
    <message>
        <source>good</source>
        <translation>bon</translation>
    </message>
    <message>
        <source>look</source>
        <translation>à voir</translation>
    </message>
    <message>
        <source>not yet</source>
        <translation>pas encore</translation>
    </message>
    <message>
        <source>poor</source>
        <translation>mauvais</translation>
    </message>
</context>
</TS>
